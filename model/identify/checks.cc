#include "model/identify/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/input_error.h"
#include "model/identify/fit.h"

namespace fjr {
namespace {

constexpr double kDoubtful = 0.2;                     // relative standard error
constexpr double kMostTurned = 4 * std::numbers::pi;  // [rad]  by a link
constexpr double kMostOutliers = 0.02;                // fraction of the samples that may be outliers
constexpr double kDegrees = 180 / std::numbers::pi;

bool near(double ratio, double factor) { return ratio > factor / 2 && ratio < factor * 2; }

std::string guess(double ratio) {
  if (near(ratio, kDegrees) || near(ratio, 1 / kDegrees)) return "; degrees in place of radians would explain it";
  if (near(ratio, 1000) || near(ratio, 1e-3)) return "; a torque in mN m or kN m, or a time in ms would explain it";
  if (near(ratio, 60 / (2 * std::numbers::pi)) || near(ratio, 2 * std::numbers::pi / 60)) {
    return "; 1/min in place of rad/s would explain it";
  }
  if (near(ratio, 1e6) || near(ratio, 1e-6))
    return "; a time in milliseconds or in thousands of seconds would explain it";
  return "; is a column in another unit, or on the motor's side of the gear?";
}

std::vector<double> intervals(const Log& log) {
  const std::vector<double>& time = log.column("time");
  std::vector<double> all;
  for (std::size_t i = 1; i < time.size(); ++i) all.push_back(time[i] - time[i - 1]);
  return all;
}

}  // namespace

void require_plausible(const Log& log, const std::string& what, double found, double expected, double factor) {
  if (!(expected > 0)) return;
  const double ratio = found / expected;
  if (!(ratio > 0)) {
    throw InputError(log.source, "", fmt::format("{} comes out as {:.4g}: a column has the wrong sign", what, found));
  }
  if (ratio > factor || ratio < 1 / factor) {
    throw InputError(
        log.source, "",
        fmt::format("{} comes out as {:.4g}, where about {:.4g} is expected{}", what, found, expected, guess(ratio)));
  }
}

void require_experiment(const Log& log, const std::string& experiment, int joint) {
  const auto named = log.metadata.find("experiment");
  if (named != log.metadata.end() && named->second != experiment) {
    throw InputError(log.source, "# experiment", fmt::format("is {}, not {}", named->second, experiment));
  }
  const double said = log.number("joint", joint + 1);
  if (said != joint + 1) throw InputError(log.source, "# joint", fmt::format("is {}, not {}", said, joint + 1));
}

void require_radians(const Log& log, int joint) {
  const std::string name = joint_column("q", joint);
  double most = 0, beyond = 0;
  for (const double q : log.column(name)) {
    beyond += std::abs(q) > kMostTurned;
    most = std::max(most, std::abs(q));
  }
  if (beyond > kMostOutliers * static_cast<double>(log.rows())) {
    throw InputError(log.source, name, fmt::format("reaches {:.4g} rad; is it in degrees?", most));
  }
}

double sample_interval(const Log& log) { return median(intervals(log)); }

void warn_of_gaps(const Log& log, std::vector<std::string>& warnings) {
  const double usual = sample_interval(log);
  double missing = 0;
  for (const double interval : intervals(log)) missing += std::max(std::round(interval / usual) - 1, 0.0);
  if (missing > 0) warnings.push_back(fmt::format("{:.0f} samples are missing of {}", missing, log.rows()));
}

void warn_of_outliers(std::size_t rejected, const std::string& what, std::vector<std::string>& warnings) {
  if (rejected > 0) warnings.push_back(fmt::format("{} {} rejected as outliers", rejected, what));
}

void warn_of_doubt(Estimate& estimate) {
  for (const std::string& name : estimate.names) {
    const double value = estimate.at(name), error = estimate.standard_error(name);
    if (error <= kDoubtful * std::abs(value)) continue;
    estimate.warnings.push_back(fmt::format("{} is hardly determined: {:.3g} +- {:.2g}", name, value, error));
  }
}

}  // namespace fjr
