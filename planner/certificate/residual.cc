#include "planner/certificate/residual.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/certificate/rollout.h"
#include "planner/control/motor_feedback.h"

namespace fjr {
namespace {

constexpr double kObserve = 1e-3;  // [s]
// Motor 2 leaves its rest at 365/s: even growth by e^(365 x 4 ms) a step is within what the implicit method follows
// (its pole is at 2.3), and it errs towards more.
constexpr double kStep = 4e-3;         // [s]
constexpr double kEquilibrium = 1e-5;  // [rad], [rad/s]
// A hundredth of a count of the link encoder, and of the 1e-3 rad/s with which motor 2 wanders.
constexpr Accuracy kAccuracyAtRest{1e-4, 1e-6, 1e-5, 1e-5};

// Accuracy while the executor holds the arm: steps of a tick, in which the friction of the dither varies by a swing of
// 2e-3 rad/s. How far a motor wanders within a count depends on rounding: of 17 plans, runs that were 1e5 times as
// accurate differed by up to 1.2e-5 rad, and runs with a method of order 3, which takes 5 evaluations of the model in
// place of 8 a tick, by up to 1.3e-4 rad, more than a count.
constexpr Accuracy kAccuracyOfTicks{1e-3, 1e-5, 1e-3, 1e-3};

// Returns the links' distance from a rest at `goal`, which has its q.
Joints<double> deviation(const State<double>& x, const Sample& goal) {
  return {std::abs(x.q[0] - goal.state.q[0]), std::abs(x.q[1] - goal.state.q[1])};
}

Sample rest_of(const Parameters& p, const Sample& goal) {
  return {goal.time, rest_at(p, goal.state.q), gravity_torque(p, goal.state.q)};
}

}  // namespace

bool is_at_rest(const Parameters& p, const Sample& row) {
  const State<double> rest = rest_at(p, row.state.q);
  for (int i = 0; i < kStates; ++i) {
    if (!(std::abs(row.state[i] - rest[i]) <= kEquilibrium)) return false;
  }
  return true;
}

// The springs are more than three times as stiff as gravity, so that 20 steps leave less than 1e-9 rad.
Joints<double> resting_with(const Parameters& p, const Joints<double>& theta) {
  Joints<double> q = theta;
  for (int i = 0; i < 20; ++i) {
    const Joints<double> at_rest = rest_at(p, q).theta;
    for (std::size_t j = 0; j < kJoints; ++j) q[j] += theta[j] - at_rest[j];
  }
  return q;
}

bool hold_at_rest(const Parameters& p, const Sample& goal, const State<double>& from, double duration,
                  const HoldObserver& observe) {
  return hold_at_rest(p, p, goal, from, duration, observe);
}

bool hold_at_rest(const Parameters& p, const Parameters& moved, const Sample& goal, const State<double>& from,
                  double duration, const HoldObserver& observe) {
  return hold_at_place(p, moved, rest_of(p, goal), from, duration, observe);
}

bool hold_at_place(const Parameters& p, const Parameters& moved, const Sample& place, const State<double>& from,
                   double duration, const HoldObserver& observe) {
  Sample rest = place, later = place;
  rest.time = 0;
  later.time = duration;
  const Trajectory resting{{rest, later}, {}};
  TickController controller(p, resting);
  Rollout arm(moved, Limits{}, kAccuracyOfTicks);
  arm.start(0, from, Drive::holding(rest));
  for (int k = 0; k * kTick < duration; ++k) {
    const State<double> before = arm.state();
    const Joints<double> torque = controller.command(k * kTick, {before.theta, before.q}).torque;
    arm.hold(torque);
    if (!arm.run((k + 1) * kTick, {}, {}, {})) return false;
    observe((k + 1) * kTick, arm.state(), torque);
  }
  return true;
}

Joints<double> deviation_at_rest(const Parameters& p, const Sample& goal, const State<double>& from) {
  Joints<double> largest = deviation(from, goal);
  const auto keep = [&](double, const State<double>& x, const Joints<double>&) {
    const Joints<double> now = deviation(x, goal);
    for (std::size_t j = 0; j < kJoints; ++j) largest[j] = std::max(largest[j], now[j]);
  };
  return hold_at_rest(p, goal, from, kResidualWindow, keep) ? largest : Joints<double>{kNoLimit, kNoLimit};
}

Joints<double> drift_at_rest(const Parameters& p, const Sample& goal, const State<double>& from) {
  Rollout arm(p, Limits{}, kAccuracyAtRest);
  arm.limit_step(kStep);
  Joints<double> largest = deviation(from, goal);
  const auto keep = [&](double, const State<double>& x) {
    const Joints<double> now = deviation(x, goal);
    for (std::size_t j = 0; j < kJoints; ++j) largest[j] = std::max(largest[j], now[j]);
  };
  std::vector<double> instants;
  for (int k = 1; k * kObserve <= kResidualWindow; ++k) instants.push_back(k * kObserve);
  arm.start(0, from, Drive::holding(rest_of(p, goal)));
  arm.run(kResidualWindow, instants, {}, keep);
  return largest;
}

}  // namespace fjr
