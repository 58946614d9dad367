#include "model/identify/agreement.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "model/identify/arm.h"

namespace fjr {
namespace {

// Returns the name of the experiment, with its log if both estimates are from the same experiment.
std::string told_by(const Estimate& e, const Estimate& other) {
  if (e.procedure != other.procedure) return e.procedure;
  return fmt::format("{} ({})", e.procedure, std::filesystem::path(e.log).filename().string());
}

// `name` means the same in every procedure that has it.
void compare(const Estimate& a, const Estimate& b, std::vector<Agreement>& found) {
  if (a.joint != b.joint) return;
  for (std::size_t i = 0; i < a.names.size(); ++i) {
    const std::string& name = a.names[i];
    if (b.index(name) < 0 || a.is_assumed(name) || b.is_assumed(name)) continue;
    found.push_back({fmt::format("{}, joint {}", name, a.joint + 1), a.units[i], told_by(a, b), told_by(b, a),
                     a.at(name), a.standard_error(name), b.at(name), b.standard_error(name)});
  }
}

}  // namespace

double Agreement::standard_errors_apart() const {
  if (first_value == second_value) return 0;
  const double apart = std::abs(first_value - second_value) / std::hypot(first_error, second_error);
  return std::isnan(apart) ? HUGE_VAL : apart;
}

std::string Agreement::sentence() const {
  return fmt::format("{}: {} says {:.6g} +- {:.2g} {}, {} says {:.6g} +- {:.2g}: {:.1f} standard errors apart",
                     parameter, first, first_value, first_error, unit, second, second_value, second_error,
                     standard_errors_apart());
}

std::vector<Agreement> agreements(const std::vector<Estimate>& estimates) {
  std::vector<Agreement> found;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    for (std::size_t k = i + 1; k < estimates.size(); ++k) compare(estimates[i], estimates[k], found);
  }
  return found;
}

bool Change::is_large() const {
  if (known == 0 || std::abs(found - known) <= kDoubtfulApart * error) return false;
  const double times = found / known;
  return times >= kLargeChange || times <= 1 / kLargeChange;
}

std::string Change::sentence() const {
  return fmt::format("{} is {:.6g} +- {:.2g}, {:.3g} times what was known, {:.6g}", name, found, error, found / known,
                     known);
}

std::vector<Change> changes(const Parameters& known, const Identified& identified) {
  std::map<std::string, double> before, after;
  const auto collect = [](const Parameters& p, std::map<std::string, double>& values) {
    visit_parameters(p, [&](const char* section, const char* name, const char*, const Joints<double>& value) {
      for (std::size_t j = 0; j < kJoints; ++j) values[fmt::format("{}.{}[{}]", section, name, j)] = value[j];
    });
  };
  collect(known, before);
  collect(identified.robot, after);
  std::vector<Change> all;
  for (std::size_t i = 0; i < identified.names.size(); ++i) {
    const std::string& name = identified.names[i];
    const auto row = static_cast<Eigen::Index>(i);
    all.push_back({name, before.at(name), after.at(name), std::sqrt(identified.covariance(row, row))});
  }
  return all;
}

}  // namespace fjr
