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

// Offsets in units of start_offset(): the four corners of a count, and one close to the start, from where motor 2
// leaves its rest most slowly and then wanders furthest.
constexpr std::array<Joints<double>, PerturbedRollouts::kStarts> kShifts{
    {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}, {1e-3, 1e-3}}};

State<double> shifted(const Parameters& p, State<double> x, const Joints<double>& shift) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    x.q[j] += shift[j] * start_offset(p, j);
    x.theta[j] += shift[j] * start_offset(p, j);
  }
  return x;
}

// Raises the largest errors so far.
void keep(Joints<double>& largest, const Joints<double>& errors) {
  for (std::size_t j = 0; j < kJoints; ++j) largest[j] = std::max(largest[j], errors[j]);
}

}  // namespace

double start_offset(const Parameters& p, std::size_t joint) { return std::numbers::pi / p.encoder.link_counts[joint]; }

std::vector<PerturbedRollouts::Rest> PerturbedRollouts::rests_in(const Parameters& p, const Trajectory& trajectory) {
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

PerturbedRollouts::PerturbedRollouts(const Parameters& p, const Trajectory& trajectory)
    : p_(p),
      trajectory_(trajectory),
      instants_(comparison_instants(trajectory)),
      corners_(torque_corners(trajectory, kCorner)),
      rests_(rests_in(p, trajectory)) {}

void PerturbedRollouts::roll_out(std::size_t start) {
  const Sample &first = trajectory_.samples.front(), &last = trajectory_.samples.back();
  Rollout arm(p_, Limits{}, Accuracy::of_predictions());
  arm.limit_step(longest_step(trajectory_));
  Perturbed& worst = from_[start];
  worst.evaluated = true;
  std::vector<Rest> rests = rests_;
  const auto raise = [&](double time, const State<double>& x, const State<double>& wanted) {
    const Joints<double> error{std::abs(x.q[0] - wanted.q[0]), std::abs(x.q[1] - wanted.q[1])};
    if (std::max(error[0], error[1]) > worst.max_link()) worst.time_of_max_link = time;
    keep(worst.link, error);
  };
  Interpolator plan(trajectory_);
  const auto observe = [&](double time, const State<double>& x) {
    raise(time, x, plan.at(time).state);
    for (Rest& rest : rests) {
      if (time == rest.row.time) rest.reached = x;
    }
  };
  const State<double> from = shifted(p_, first.state, kShifts[start]);
  observe(first.time, from);
  arm.start(first.time, from, Drive::closed_loop(trajectory_, p_));
  worst.completed = arm.run(last.time, instants_, corners_, observe);
  for (const Rest& rest : rests) {
    worst.completed &= hold_at_rest(p_, rest.row, rest.reached, rest.to - rest.row.time,
                                    [&](double after, const State<double>& x, const Joints<double>&) {
                                      raise(rest.row.time + after, x, rest.row.state);
                                    });
  }
  if (is_at_rest(p_, last) && worst.completed) keep(worst.after, deviation_at_rest(p_, last, arm.state()));
}

Perturbed PerturbedRollouts::worst() const {
  Perturbed worst = from_.front();
  for (std::size_t i = 1; i < from_.size(); ++i) {
    if (from_[i].max_link() > worst.max_link()) worst.time_of_max_link = from_[i].time_of_max_link;
    keep(worst.link, from_[i].link);
    keep(worst.after, from_[i].after);
    worst.completed &= from_[i].completed;
  }
  return worst;
}

Perturbed roll_out_perturbed(const Parameters& p, const Trajectory& trajectory) {
  PerturbedRollouts rollouts(p, trajectory);
  for (std::size_t i = 0; i < PerturbedRollouts::kStarts; ++i) rollouts.roll_out(i);
  return rollouts.worst();
}

}  // namespace fjr
