#include "model/identify/repeated.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/input_error.h"

namespace fjr {
namespace {

using Places = std::vector<Eigen::Index>;

Places determined_by(const Estimate& e) {
  Places places;
  for (std::size_t i = 0; i < e.names.size(); ++i) {
    if (!e.is_assumed(e.names[i])) places.push_back(static_cast<Eigen::Index>(i));
  }
  return places;
}

// Returns the inverse of a positive definite matrix whose rows have different units, scaled accordingly.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::Index n = matrix.rows();
  return scale.asDiagonal() * scaled.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) * scale.asDiagonal();
}

void require_standard_errors(const Estimate& e) {
  for (const std::string& name : e.names) {
    if (e.is_assumed(name) || (std::isfinite(e.at(name)) && e.standard_error(name) > 0)) continue;
    throw InputError(e.log, "",
                     fmt::format("tells {} without a standard error, so that its weight beside another log "
                                 "of the same experiment is unknown; leave it out",
                                 name));
  }
}

void require_another_log(const Estimate& e, const Repeated& others) {
  for (const Estimate* other : others.logs) {
    if (e.hash.empty() || e.hash != other->hash) continue;
    throw InputError(e.log, "", "is the same log as " + other->log + ", which would count twice; leave it out");
  }
}

// Returns the information matrix of one log, with zero rows for parameters that it does not determine.
Eigen::MatrixXd information_of(const Estimate& e) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(e.value.size(), e.value.size());
  const Places own = determined_by(e);
  information(own, own) = inverse(e.covariance(own, own));
  return information;
}

// Returns the value of a parameter that no log determines.
double assumed_value(const std::vector<const Estimate*>& logs, Eigen::Index place) {
  double value = 0;
  for (const Estimate* e : logs) {
    if (std::abs(e->value[place]) > std::abs(value)) value = e->value[place];
  }
  return value;
}

Estimate combined(const std::vector<const Estimate*>& logs) {
  Estimate all = *logs.front();
  const Eigen::Index n = all.value.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(n);
  std::size_t told = 0;
  std::vector<std::string> sources;
  all.points = 0;
  for (const Estimate* e : logs) {
    require_standard_errors(*e);
    const Eigen::MatrixXd own = information_of(*e);
    information += own;
    pull += own * e->value;
    told += determined_by(*e).size();
    all.points += e->points;
    sources.push_back(e->log);
  }
  all.log = fmt::format("{}", fmt::join(sources, ", "));
  all.hash.clear();
  all.warnings.clear();
  all.fitted.reset();
  all.assumed.clear();
  Places known;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (information(i, i) > 0) {
      known.push_back(i);
      continue;
    }
    all.value[i] = assumed_value(logs, i);
    all.assumed.push_back(all.names[static_cast<std::size_t>(i)]);
  }
  const Eigen::MatrixXd covariance = inverse(information(known, known));
  all.value(known) = covariance * pull(known);
  double chi_square = 0;
  for (const Estimate* e : logs) {
    const Eigen::VectorXd off = e->value - all.value;
    chi_square += off.dot(information_of(*e) * off);
  }
  const double degrees = static_cast<double>(told - known.size());
  all.covariance = Eigen::MatrixXd::Zero(n, n);
  all.covariance(known, known) = covariance * (degrees > 0 ? std::max(chi_square / degrees, 1.0) : 1.0);
  return all;
}

}  // namespace

std::vector<Repeated> combine_repeated(const std::vector<Estimate>& estimates) {
  std::vector<Repeated> all;
  for (const Estimate& e : estimates) {
    const auto same = std::find_if(all.begin(), all.end(), [&](const Repeated& r) {
      return r.estimate.procedure == e.procedure && r.estimate.joint == e.joint;
    });
    if (same == all.end()) {
      all.push_back({e, {&e}});
      continue;
    }
    require_another_log(e, *same);
    same->logs.push_back(&e);
  }
  for (Repeated& r : all) {
    if (r.logs.size() > 1) r.estimate = combined(r.logs);
  }
  return all;
}

}  // namespace fjr
