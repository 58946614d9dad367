#include "planner/identify/prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fjr {
namespace {

constexpr std::array<const char*, 6> kUsuallyTold{"link.inertia",  "link.gravity_torque", "spring.stiffness",
                                                  "motor.inertia", "friction.viscous",    "friction.amplitude"};

void assume(Prior& prior, const std::string& name, double deviation) {
  if (!(deviation > 0) || std::find(prior.names.begin(), prior.names.end(), name) != prior.names.end()) return;
  const Eigen::Index n = prior.factor.rows(), r = prior.factor.cols();
  prior.names.push_back(name);
  prior.assumed.push_back(true);
  prior.factor.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 1, r + 1));
  prior.factor(n, r) = deviation;
}

}  // namespace

Prior prior_of(const Parameters& robot, double widened) {
  const Uncertainty known = uncertainty_of(robot);
  Prior prior;
  prior.names = known.names;
  prior.assumed.assign(known.names.size(), false);
  if (!known.none()) prior.factor = widened * known.factor();
  Parameters values = robot;
  for (const char* entry : kUsuallyTold) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const std::string name = fmt::format("{}[{}]", entry, j);
      assume(prior, name, kUnknownFraction * std::abs(*parameter_named(values, name)));
    }
  }
  assume(prior, "payload.mass", kUnknownPayload);
  prior.deviation = prior.factor.rowwise().norm();
  return prior;
}

}  // namespace fjr
