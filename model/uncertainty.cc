#include "model/uncertainty.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "common/strict_yaml.h"

namespace fjr {
namespace {

// Eigenvalues of the correlation matrix below this count as zero, because files are written with ten digits.
constexpr double kNegligibleVariance = 1e-8;

bool can_be_uncertain(std::string_view section, std::string_view name) {
  return section == "link" ? name != "radius" : section == "spring" || section == "motor" || section == "friction";
}

std::string scalar_name(std::string_view section, std::string_view name, std::size_t joint) {
  return fmt::format("{}.{}[{}]", section, name, joint);
}

// Returns the correlation matrix: the covariance with each parameter in units of its standard error.
Eigen::MatrixXd correlations(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& errors) {
  const Eigen::VectorXd inverse = errors.unaryExpr([](double e) { return e > 0 ? 1 / e : 0.0; });
  return inverse.asDiagonal() * covariance * inverse.asDiagonal();
}

Eigen::VectorXd standard_errors(const Eigen::MatrixXd& covariance) {
  return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

// One block under construction, then all of them.
struct Reader {
  std::map<std::string, bool> uncertain;  // every scalar by its name, and whether its error counts
  std::vector<std::string> seen;
  std::map<std::pair<std::string, std::string>, double> entries{};

  void read_names(const YamlNode& list, std::vector<std::string>& names) {
    for (const YamlNode& name : list.items()) {
      if (!uncertain.contains(name.text())) {
        name.fail(shown(name.text()) + " is not a parameter; parameters are written like \"spring.stiffness[0]\"");
      }
      if (std::find(seen.begin(), seen.end(), name.text()) != seen.end()) {
        name.fail(shown(name.text()) + " is given twice");
      }
      seen.push_back(name.text());
      names.push_back(name.text());
    }
  }

  void read_block(const YamlNode& block) {
    block.allow_keys({"names", "matrix"});
    std::vector<std::string> names;
    read_names(block.at("names"), names);
    const YamlNode matrix = block.at("matrix");
    const std::vector<YamlNode> rows = matrix.items();
    const auto size = static_cast<Eigen::Index>(names.size());
    if (rows.size() != names.size()) {
      matrix.fail(fmt::format("has {} rows, but covariance.names has {}", rows.size(), size));
    }
    Eigen::MatrixXd values(size, size);
    for (Eigen::Index i = 0; i < size; ++i) read_row(rows[static_cast<std::size_t>(i)], i, values);
    check(rows, matrix, values);
    for (std::size_t i = 0; i < names.size(); ++i) {
      for (std::size_t j = 0; j < names.size(); ++j) {
        entries[{names[i], names[j]}] = values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
  }

  static void read_row(const YamlNode& row, Eigen::Index i, Eigen::MatrixXd& values) {
    const std::vector<YamlNode> items = row.items();
    if (static_cast<Eigen::Index>(items.size()) != values.cols()) {
      row.fail(fmt::format("has {} values, but covariance.names has {}", items.size(), values.cols()));
    }
    for (Eigen::Index j = 0; j < values.cols(); ++j) values(i, j) = items[static_cast<std::size_t>(j)].number("1");
  }

  static void check(const std::vector<YamlNode>& rows, const YamlNode& matrix, const Eigen::MatrixXd& values) {
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      const auto row = static_cast<std::size_t>(i);
      if (!(values(i, i) >= 0)) rows[row].fail_at(row, fmt::format("a variance of {} must be >= 0", values(i, i)));
      for (Eigen::Index j = 0; j < i; ++j) {
        if (values(i, j) == values(j, i)) continue;
        rows[row].fail_at(static_cast<std::size_t>(j),
                          fmt::format("{} must equal matrix[{}][{}], {}", values(i, j), j, i, values(j, i)));
      }
    }
    const Eigen::MatrixXd correlation = correlations(values, standard_errors(values));
    if (correlation.rows() == 0) return;
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlation).eigenvalues()[0];
    if (least < -1e-6 || correlation.cwiseAbs().maxCoeff() > 1 + 1e-6) {
      matrix.fail("is no covariance: a combination of its parameters would have a negative variance");
    }
  }

  // Adds the standard error of a parameter to the diagonal if no block has named it.
  void read_standard_error(const YamlNode& entry, std::string_view section, std::string_view name) {
    const YamlNode error = entry.at("standard_error");
    if (error.is_null()) return;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const std::string scalar = scalar_name(section, name, j);
      const YamlNode of_joint = error.items()[j];
      if (of_joint.is_null() || std::find(seen.begin(), seen.end(), scalar) != seen.end()) continue;
      const double value = of_joint.number("1");
      entries[{scalar, scalar}] = value * value;
    }
  }
};

// Returns the Jacobian from the errors of the file's values to those of Parameters: an inertia about another point
// changes by m (alpha l)^2.
Eigen::MatrixXd moved_inertias(const YamlNode& root, const Parameters& p, const std::vector<std::string>& names) {
  const auto size = static_cast<Eigen::Index>(names.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Identity(size, size);
  const auto about = root.at("link").at("inertia").find("about");
  if (!about) return jacobian;
  const auto index = [&](const char* name, std::size_t j) -> std::optional<Eigen::Index> {
    const auto found = std::find(names.begin(), names.end(), scalar_name("link", name, j));
    return found == names.end() ? std::nullopt : std::optional<Eigen::Index>(found - names.begin());
  };
  for (std::size_t j = 0; j < kJoints; ++j) {
    const bool about_com = about->items()[j].says("center_of_mass");
    const double sign = j == 0 ? (about_com ? 1 : 0) : (about_com ? 0 : -1);
    const auto row = index("inertia", j);
    if (sign == 0 || !row) continue;
    const double m = p.link.mass[j], alpha = p.link.com_fraction[j], l = p.link.length[j];
    const std::pair<const char*, double> by[] = {{"mass", alpha * alpha * l * l},
                                                 {"com_fraction", 2 * m * alpha * l * l},
                                                 {"length", 2 * m * alpha * alpha * l}};
    for (const auto& [name, slope] : by) {
      if (const auto column = index(name, j)) jacobian(*row, *column) = sign * slope;
    }
  }
  return jacobian;
}

bool has(const Uncertainty& u, const char* name) {
  return std::find(u.names.begin(), u.names.end(), name) != u.names.end();
}

bool is_about(const Uncertainty& u, const Payload& payload) {
  return u.payload == payload && u.payload.mass_error == payload.mass_error &&
         u.payload.inertia_error == payload.inertia_error;
}

Uncertainty without_payload(const Uncertainty& u) {
  Uncertainty of_arm;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < u.names.size(); ++i) {
    if (u.names[i].starts_with("payload.")) continue;
    kept.push_back(static_cast<Eigen::Index>(i));
    of_arm.names.push_back(u.names[i]);
  }
  of_arm.covariance = u.covariance(kept, kept);
  return of_arm;
}

void append(Uncertainty& to, const char* name, double error) {
  if (!(error > 0) || has(to, name)) return;
  const Eigen::Index n = to.covariance.rows();
  to.names.emplace_back(name);
  to.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 1, n + 1));
  to.covariance(n, n) = error * error;
}

}  // namespace

double Uncertainty::standard_error(std::size_t i) const {
  const auto k = static_cast<Eigen::Index>(i);
  return std::sqrt(covariance(k, k));
}

Eigen::MatrixXd Uncertainty::factor() const {
  if (none()) return {};
  const Eigen::VectorXd errors = standard_errors(covariance);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of(correlations(covariance, errors));
  const Eigen::VectorXd& variances = of.eigenvalues();  // increasing
  const Eigen::Index rank = (variances.array() > kNegligibleVariance).count();
  return errors.asDiagonal() * of.eigenvectors().rightCols(rank) * variances.tail(rank).cwiseSqrt().asDiagonal();
}

Uncertainty read_uncertainty(const YamlNode& root, const Parameters& p) {
  Reader reader;
  std::vector<std::string> in_order;
  visit_parameters(p, [&](std::string_view section, std::string_view name, auto, const Joints<double>&) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      in_order.push_back(scalar_name(section, name, j));
      reader.uncertain[in_order.back()] = can_be_uncertain(section, name);
    }
  });
  for (const char* name : {"payload.mass", "payload.inertia"}) {
    in_order.emplace_back(name);
    reader.uncertain[name] = true;
  }
  if (const auto covariance = root.find("covariance")) {
    if (covariance->is_list()) {
      for (const YamlNode& block : covariance->items()) reader.read_block(block);
    } else {
      reader.read_block(*covariance);
    }
  }
  visit_parameters(p, [&](std::string_view section, std::string_view name, auto, const Joints<double>&) {
    if (const auto entry = root.at(section).find(name)) reader.read_standard_error(*entry, section, name);
  });
  Uncertainty found;
  for (const std::string& name : in_order) {
    const auto variance = reader.entries.find({name, name});
    if (variance != reader.entries.end() && variance->second > 0 && reader.uncertain[name]) found.names.push_back(name);
  }
  const auto size = static_cast<Eigen::Index>(found.names.size());
  found.covariance = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      const auto entry =
          reader.entries.find({found.names[static_cast<std::size_t>(i)], found.names[static_cast<std::size_t>(j)]});
      if (entry != reader.entries.end()) found.covariance(i, j) = entry->second;
    }
  }
  const Eigen::MatrixXd jacobian = moved_inertias(root, p, found.names);
  found.covariance = jacobian * found.covariance * jacobian.transpose();
  if (const auto payload = root.find("payload")) found.payload = read_payload(*payload);
  return found;
}

Uncertainty uncertainty_of(const Parameters& p) {
  Uncertainty all = p.uncertainty ? *p.uncertainty : Uncertainty{};
  if (!is_about(all, p.payload)) all = without_payload(all);
  append(all, "payload.mass", p.payload.mass_error);
  append(all, "payload.inertia", p.payload.inertia_error);
  return all;
}

double* parameter_named(Parameters& p, std::string_view wanted) {
  if (wanted == "payload.mass") return &p.payload.mass;
  if (wanted == "payload.inertia") return &p.payload.inertia;
  double* found = nullptr;
  visit_parameters(p, [&](std::string_view section, std::string_view name, auto, Joints<double>& values) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (scalar_name(section, name, j) == wanted) found = &values[j];
    }
  });
  return found;
}

Parameters changed(const Parameters& p, const std::vector<std::string>& names, const Eigen::VectorXd& change) {
  Parameters other = p;
  for (std::size_t i = 0; i < names.size(); ++i) {
    double& value = *parameter_named(other, names[i]);
    value += change[static_cast<Eigen::Index>(i)];
    if (names[i].starts_with("payload.") || names[i].starts_with("link.mass")) value = std::max(value, 0.0);
  }
  return other;
}

}  // namespace fjr
