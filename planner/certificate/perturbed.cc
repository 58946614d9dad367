#include "planner/certificate/perturbed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
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

// Where the plan stays at one place, for long enough that the executor's dither begins.
struct Rest {
  Sample row;             // the first of it
  double to;              // [s]
  State<double> reached;  // by the rollout, at its beginning
};

std::vector<Rest> rests_in(const Parameters& p, const Trajectory& trajectory) {
  constexpr double kSamePlace = 1e-5;  // [rad]
  std::vector<Rest> rests;
  bool resting = false;
  for (const Sample& row : trajectory.samples) {
    const bool rests_here = is_at_rest(p, row);
    const auto stays = [&](std::size_t j) {
      return std::abs(row.state.q[j] - rests.back().row.state.q[j]) < kSamePlace;
    };
    if (resting && rests_here && stays(0) && stays(1)) {
      rests.back().to = row.time;
    } else if (rests_here) {
      rests.push_back({row, row.time, row.state});
    }
    resting = rests_here;
  }
  std::erase_if(rests, [](const Rest& rest) { return rest.to - rest.row.time <= kDitherAfter * kTick; });
  return rests;
}

// Largest errors so far, and this.
void keep(Joints<double>& largest, const Joints<double>& errors) {
  for (std::size_t j = 0; j < kJoints; ++j) largest[j] = std::max(largest[j], errors[j]);
}

// What is the same from wherever the trajectory is begun.
struct Course {
  std::vector<double> instants, corners;  // [s]
  std::vector<Rest> rests;
};

Perturbed roll_out_from(const Parameters& p, const Trajectory& trajectory, const Course& course,
                        const Joints<double>& shift) {
  const Sample &first = trajectory.samples.front(), &last = trajectory.samples.back();
  Rollout arm(p, Limits{}, Accuracy::of_predictions());
  arm.limit_step(longest_step(trajectory));
  Perturbed worst;
  worst.evaluated = true;
  std::vector<Rest> rests = course.rests;
  const auto raise = [&](double time, const State<double>& x, const State<double>& wanted) {
    const Joints<double> error{std::abs(x.q[0] - wanted.q[0]), std::abs(x.q[1] - wanted.q[1])};
    if (std::max(error[0], error[1]) > worst.max_link()) worst.time_of_max_link = time;
    keep(worst.link, error);
  };
  Interpolator plan(trajectory);
  const auto observe = [&](double time, const State<double>& x) {
    raise(time, x, plan.at(time).state);
    for (Rest& rest : rests) {
      if (time == rest.row.time) rest.reached = x;
    }
  };
  const State<double> start = shifted(p, first.state, shift);
  observe(first.time, start);
  arm.start(first.time, start, Drive::closed_loop(trajectory, p));
  worst.completed = arm.run(last.time, course.instants, course.corners, observe);
  for (const Rest& rest : rests) {
    worst.completed &= hold_at_rest(p, rest.row, rest.reached, rest.to - rest.row.time,
                                    [&](double after, const State<double>& x, const Joints<double>&) {
                                      raise(rest.row.time + after, x, rest.row.state);
                                    });
  }
  if (is_at_rest(p, last) && worst.completed) keep(worst.after, deviation_at_rest(p, last, arm.state()));
  return worst;
}

}  // namespace

double start_offset(const Parameters& p, std::size_t joint) { return std::numbers::pi / p.encoder.link_counts[joint]; }

Perturbed roll_out_perturbed(const Parameters& p, const Trajectory& trajectory, const ForEach& for_each) {
  const Course course{comparison_instants(trajectory), torque_corners(trajectory, kCorner), rests_in(p, trajectory)};
  std::array<Perturbed, std::size(kShifts)> all;
  for_each(all.size(), [&](std::size_t i) { all[i] = roll_out_from(p, trajectory, course, kShifts[i]); });
  Perturbed worst = all.front();
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i].max_link() > worst.max_link()) worst.time_of_max_link = all[i].time_of_max_link;
    keep(worst.link, all[i].link);
    keep(worst.after, all[i].after);
    worst.completed &= all[i].completed;
  }
  return worst;
}

}  // namespace fjr
