#include "planner/certificate/perturbed.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "planner/certificate/comparison.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/rollout.h"

namespace fjr {
namespace {

// In start_offset(): the four corners of a count, and next to the start, where motor 2 leaves its rest most slowly and
// then wanders furthest.
constexpr Joints<double> kShifts[] = {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}, {1e-3, 1e-3}};

State<double> shifted(const Parameters& p, State<double> x, const Joints<double>& shift) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    x.q[j] += shift[j] * start_offset(p, j);
    x.theta[j] += shift[j] * start_offset(p, j);
  }
  return x;
}

// Of the links about the goal, on springs whose motors stand. [J]
double energy_about(const Parameters& p, const Sample& goal, const State<double>& x) {
  const MassMatrix<double> m = mass_matrix(p, goal.state.q[1]);
  double twice = m.m11 * x.dq[0] * x.dq[0] + 2 * m.m12 * x.dq[0] * x.dq[1] + m.m22 * x.dq[1] * x.dq[1];
  for (std::size_t j = 0; j < kJoints; ++j) twice += p.spring.stiffness[j] * std::pow(x.q[j] - goal.state.q[j], 2);
  return twice / 2;
}

// Largest errors so far, and this.
void keep(Joints<double>& largest, const Joints<double>& errors) {
  for (std::size_t j = 0; j < kJoints; ++j) largest[j] = std::max(largest[j], errors[j]);
}

}  // namespace

double start_offset(const Parameters& p, std::size_t joint) { return std::numbers::pi / p.encoder.link_counts[joint]; }

Perturbed roll_out_perturbed(const Parameters& p, const Trajectory& trajectory) {
  const Sample &first = trajectory.samples.front(), &last = trajectory.samples.back();
  const std::vector<double> instants = comparison_instants(trajectory), corners = torque_corners(trajectory, kCorner);
  const bool ends_at_rest = is_at_rest(p, last);
  Rollout arm(p, Limits{}, Accuracy::of_predictions());
  arm.limit_step(longest_step(trajectory));
  Perturbed worst;
  worst.evaluated = worst.completed = true;
  State<double> liveliest = last.state;
  for (const Joints<double>& shift : kShifts) {
    Interpolator plan(trajectory);
    const auto observe = [&](double time, const State<double>& x) {
      const State<double> wanted = plan.at(time).state;
      const Joints<double> error{std::abs(x.q[0] - wanted.q[0]), std::abs(x.q[1] - wanted.q[1])};
      if (std::max(error[0], error[1]) > worst.max_link()) worst.time_of_max_link = time;
      keep(worst.link, error);
    };
    const State<double> start = shifted(p, first.state, shift);
    observe(first.time, start);
    arm.start(first.time, start, Drive::closed_loop(trajectory, p));
    worst.completed &= arm.run(last.time, instants, corners, observe);
    if (!(energy_about(p, last, arm.state()) <= energy_about(p, last, liveliest))) liveliest = arm.state();
  }
  if (ends_at_rest && worst.completed) worst.after = deviation_at_rest(p, last, liveliest);
  return worst;
}

}  // namespace fjr
