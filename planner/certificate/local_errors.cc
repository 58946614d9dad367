// Local error of every interval of a mesh.
#include <algorithm>

#include "planner/certificate/certificate.h"
#include "planner/certificate/judge.h"
#include "planner/certificate/rollout.h"

namespace fjr {
namespace {

// Mesh refinement compares these errors with fractions of the exactness tolerance, 1e-4 rad: 1e-7 is ample.
constexpr Accuracy kAccuracy{1e-7, 1e-9, 1e-8, 1e-8};
constexpr double kSteep = 100;  // [N m/s]

State<double> infinite() {
  State<double> x;
  for (std::size_t i = 0; i < kStates; ++i) x[i] = kNoLimit;
  return x;
}

State<double> difference(const State<double>& a, const State<double>& b) {
  State<double> d;
  for (int i = 0; i < kStates; ++i) d[i] = a[i] - b[i];
  return d;
}

}  // namespace

std::vector<State<double>> local_errors(const Parameters& robot, const Trajectory& trajectory,
                                        const std::vector<double>& times) {
  std::vector<State<double>> errors;
  if (times.size() < 2) return errors;
  errors.reserve(times.size() - 1);
  Interpolator plan(trajectory);
  const std::vector<double> corners = torque_corners(trajectory, kSteep);
  const Drive drive = Drive::open_loop(trajectory);
  Rollout rollout(robot, Limits{}, kAccuracy);
  rollout.limit_step(longest_step(trajectory));
  auto corner = corners.begin();
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    corner = std::upper_bound(corner, corners.end(), times[k]);
    rollout.start(times[k], plan.at(times[k]).state, drive);
    const bool arrived = rollout.run(times[k + 1], {}, {corner, corners.end()}, {});
    errors.push_back(arrived ? difference(rollout.state(), plan.at(times[k + 1]).state) : infinite());
  }
  return errors;
}

}  // namespace fjr
