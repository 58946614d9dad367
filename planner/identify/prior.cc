#include "planner/identify/prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fjr {
namespace {

constexpr std::array<const char*, 6> kUsuallyTold{"link.inertia",  "link.gravity_torque", "spring.stiffness",
                                                  "motor.inertia", "friction.viscous",    "friction.amplitude"};

constexpr const char* kPayloadMass = "payload.mass";

void assume(Prior& prior, const std::string& name, double deviation) {
  if (!(deviation > 0) || std::find(prior.names.begin(), prior.names.end(), name) != prior.names.end()) return;
  const Eigen::Index n = prior.factor.rows(), r = prior.factor.cols();
  prior.names.push_back(name);
  prior.assumed.push_back(true);
  prior.factor.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 1, r + 1));
  prior.factor(n, r) = deviation;
}

// Returns the uncertainty of the other parameters, conditional on the payload's mass being exact.
Uncertainty without_payload_mass(Uncertainty u) {
  const auto found = std::find(u.names.begin(), u.names.end(), kPayloadMass);
  if (found == u.names.end()) return u;
  const Eigen::Index k = found - u.names.begin(), n = u.covariance.rows();
  const Eigen::VectorXd with_mass = u.covariance.col(k);
  u.covariance -= with_mass * with_mass.transpose() / with_mass[k];
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i != k) kept.push_back(i);
  }
  u.covariance = Eigen::MatrixXd(u.covariance(kept, kept));
  u.names.erase(found);
  return u;
}

}  // namespace

Prior prior_of(const Parameters& robot, double widened, PayloadMass payload) {
  Uncertainty known = uncertainty_of(robot);
  if (payload == PayloadMass::kKnown) known = without_payload_mass(std::move(known));
  Prior prior;
  prior.names = known.names;
  prior.assumed.assign(known.names.size(), false);
  if (!known.none()) prior.factor = widened * known.factor();
  Parameters values = robot;
  for (const std::string& name : usually_told(robot)) {
    if (name != kPayloadMass) {
      assume(prior, name, kUnknownFraction * std::abs(*parameter_named(values, name)));
    } else if (payload == PayloadMass::kUncertain) {
      assume(prior, name, kUnknownPayload);
    }
  }
  prior.deviation = prior.factor.rowwise().norm();
  return prior;
}

std::vector<std::string> usually_told(const Parameters& robot) {
  Parameters values = robot;
  std::vector<std::string> names;
  for (const char* entry : kUsuallyTold) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      std::string name = fmt::format("{}[{}]", entry, j);
      if (*parameter_named(values, name) != 0) names.push_back(std::move(name));
    }
  }
  names.emplace_back(kPayloadMass);
  return names;
}

std::string unit_of(const std::string& name) {
  if (name == kPayloadMass) return "kg";
  if (name == "payload.inertia") return "kg m^2";
  std::string found;
  const Parameters any{};
  visit_parameters(any, [&](const std::string& section, const std::string& entry, const char* unit, const auto&) {
    if (name.starts_with(section + "." + entry + "[")) found = unit;
  });
  return found;
}

}  // namespace fjr
