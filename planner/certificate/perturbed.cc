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
constexpr Pair<double> kShifts[] = {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}, {1e-3, 1e-3}};

State<double> shifted(const Parameters& p, State<double> x, const Pair<double>& shift) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    x.q[j] += shift[j] * start_offset(p, j);
    x.theta[j] += shift[j] * start_offset(p, j);
  }
  return x;
}

// Largest errors so far, and this.
void keep(Pair<double>& largest, const Pair<double>& errors) {
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
  for (const Pair<double>& shift : kShifts) {
    Interpolator plan(trajectory);
    const auto observe = [&](double time, const State<double>& x) {
      const State<double> wanted = plan.at(time).state;
      const Pair<double> error{std::abs(x.q[0] - wanted.q[0]), std::abs(x.q[1] - wanted.q[1])};
      if (std::max(error[0], error[1]) > worst.max_link()) worst.time_of_max_link = time;
      keep(worst.link, error);
    };
    const State<double> start = shifted(p, first.state, shift);
    observe(first.time, start);
    arm.start(first.time, start, Drive::closed_loop(trajectory, p));
    worst.completed &= arm.run(last.time, instants, corners, observe);
    if (ends_at_rest && worst.completed) keep(worst.after, deviation_at_rest(p, last, arm.state()));
  }
  return worst;
}

}  // namespace fjr
