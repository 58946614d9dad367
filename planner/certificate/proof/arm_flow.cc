#include "planner/certificate/proof/arm_flow.h"

#include <algorithm>
#include <memory>
#include <set>

#include "common/enclosure/held.h"
#include "model/dynamics.h"

namespace fjr {
namespace {

using enclosure::Active;
using enclosure::Ball;
using enclosure::Balls;
using enclosure::Polynomial;
using enclosure::Recording;

// Of orders from 8 to 16 with remainders from 1e-16 to 1e-11 these were the quickest, or nearly, in all trials.
// slope_order is lower because the derivatives of the flow only map narrow sets: with all orders the same, it took half
// as long again.
constexpr enclosure::FlowOptions kOptions{.order = kArmOrder, .slope_order = 6, .remainder = 1e-12, .shortest = 1e-12};

// Units in which the orbits of the arm's vibrations, of 10 to 70 rad/s, are about circles. [rad], [rad/s]
constexpr std::array<double, kStates> kScale{1, 1, 16, 32, 1, 1, 16, 32};

// dx/dt of the exact model (dynamics()) under tau_m = signal - Kp theta - Kd dtheta.
Recording arm(const Parameters& robot, const Drive& drive) {
  Recording recording(kStates + kJoints);
  State<Active> x;
  for (std::size_t i = 0; i < kStates; ++i) x[i] = recording.input(i);
  Joints<Active> torque;
  for (std::size_t j = 0; j < kJoints; ++j) {
    torque[j] = recording.input(kStates + j);
    if (drive.position_gain[j] != 0) torque[j] -= drive.position_gain[j] * x.theta[j];
    if (drive.velocity_gain[j] != 0) torque[j] -= drive.velocity_gain[j] * x.dtheta[j];
  }
  const State<Active> rate = dynamics(robot, x, torque);
  for (std::size_t i = 0; i < kStates; ++i) recording.output(rate[i]);
  return recording;
}

// tau(t) + Kp theta(t) + Kd dtheta(t) of the plan, and the dither of the tick.
std::vector<Polynomial> signals(const RowPolynomials& plan, const Drive& drive, const Joints<double>& dither) {
  std::vector<Polynomial> u;
  for (std::size_t j = 0; j < kJoints; ++j) {
    Polynomial c = plan.torque[j];
    c.resize(plan.state.theta[j].size());
    c[0] += dither[j];
    for (std::size_t k = 0; k < c.size(); ++k) {
      c[k] += drive.position_gain[j] * plan.state.theta[j][k];
      if (k < plan.state.dtheta[j].size()) c[k] += drive.velocity_gain[j] * plan.state.dtheta[j][k];
    }
    u.push_back(std::move(c));
  }
  return u;
}

// Returns the times at which the drive's polynomials change: rows, and ticks with dither.
std::vector<double> breakpoints(const Trajectory& trajectory, const Drive& drive, double from, double to) {
  std::set<double> times{from, to};
  const auto inside = [&](double time) { return from < time && time < to; };
  for (const Sample& row : trajectory.samples) {
    if (inside(row.time)) times.insert(row.time);
  }
  if (drive.dither) {
    std::copy_if(drive.dither->steps().begin(), drive.dither->steps().end(), std::inserter(times, times.end()), inside);
  }
  return {times.begin(), times.end()};
}

// Returns the polynomials between the two rows around `time`, as functions of the time since then.
RowPolynomials plan_from(const Trajectory& trajectory, double time) {
  const std::vector<Sample>& rows = trajectory.samples;
  const auto after = std::upper_bound(rows.begin() + 1, rows.end() - 1, time,
                                      [](double t, const Sample& row) { return t < row.time; });
  const RowPolynomials between = RowPolynomials::between(*(after - 1), *after);
  return time == (after - 1)->time ? between : between.shifted(Ball(time) - Ball((after - 1)->time));
}

Balls<kStates> state_at_beginning(const RowPolynomials& plan) {
  Balls<kStates> x;
  for (std::size_t i = 0; i < kStates; ++i) x[i] = plan.state[i][0];
  return x;
}

// The arm under one drive, from one breakpoint to the next.
class ArmFlow {
 public:
  ArmFlow(const Parameters& robot, const Drive& drive) : model_(arm(robot, drive)), flow_(model_, kOptions) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      held_[j] = std::make_unique<enclosure::HeldFlow<kStates>>(model_, kStateDtheta + j, kOptions);
    }
  }

  ArmFlow(const ArmFlow&) = delete;  // its parts point to its model
  ArmFlow& operator=(const ArmFlow&) = delete;

  void start(const enclosure::Set<kStates>& set) { flow_.start(set); }
  const enclosure::Set<kStates>& set() const { return flow_.set(); }

  // Does the same as Flow::run(). A motor that stays in steep friction all the time is treated as held, because its
  // series would take forty steps and more for a millisecond.
  template <class Observe>
  bool run(const std::vector<Polynomial>& signals, const Ball& duration, const Observe& observe) {
    for (auto& held : held_) {
      enclosure::Set<kStates> set = flow_.set();
      const enclosure::Holding result = held->run(set, signals, duration, observe);
      if (result == enclosure::Holding::kNotHeld) continue;
      reached_ = held->reached();
      flow_.start(set);
      return result == enclosure::Holding::kHeld;
    }
    const bool followed = flow_.run(signals, duration, observe);
    reached_ = flow_.reached();
    return followed;
  }
  double reached() const { return reached_; }
  long steps() const {
    long steps = flow_.steps();
    for (const auto& held : held_) steps += held->steps();
    return steps;
  }

 private:
  Recording model_;
  enclosure::Flow<kStates> flow_;
  Joints<std::unique_ptr<enclosure::HeldFlow<kStates>>> held_;
  double reached_ = 0;
};

}  // namespace

Followed follow(const Parameters& robot, const Trajectory& trajectory, const std::vector<Piece>& pieces,
                const std::function<bool(const ArmStep&)>& observe) {
  const enclosure::RoundingToNearest nearest;
  Followed result;
  std::optional<enclosure::Set<kStates>> reached;
  double from = trajectory.start_time();
  for (const Piece& piece : pieces) {
    ArmFlow flow(robot, piece.drive);
    flow.start(piece.afresh || !reached
                   ? enclosure::Set<kStates>(state_at_beginning(plan_from(trajectory, from)), kScale)
                   : *reached);
    const std::vector<double> times = breakpoints(trajectory, piece.drive, from, piece.to);
    for (std::size_t k = 0; k + 1 < times.size(); ++k) {
      const RowPolynomials plan = plan_from(trajectory, times[k]);
      const Joints<double> dither =
          piece.drive.dither ? piece.drive.dither->at((times[k] + times[k + 1]) / 2) : Joints<double>{};
      const bool followed = flow.run(signals(plan, piece.drive, dither), Ball(times[k + 1]) - Ball(times[k]),
                                     [&](const enclosure::Step<kStates>& step) {
                                       for (std::size_t j = 0; j < kJoints; ++j)
                                         result.width = std::max(result.width, step.near[kStateQ + j][0].rad);
                                       return observe({times[k] + step.from.mid, plan.shifted(step.from), step});
                                     });
      result.until = times[k] + flow.reached();
      if (followed) continue;
      result.steps += flow.steps();
      return result;
    }
    result.steps += flow.steps();
    reached = flow.set();
    result.until = from = piece.to;
  }
  result.completed = true;
  return result;
}

}  // namespace fjr
