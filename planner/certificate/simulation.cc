#include "planner/certificate/simulation.h"

#include <algorithm>
#include <cmath>

#include "planner/certificate/comparison.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/rollout.h"
#include "planner/certificate/ticks.h"

namespace fjr {
namespace {

constexpr double kStill = 1e-5;  // [rad/s] as of a rest

// Returns whether a learnt row is a rest. Learnt rows belong to an arm that is not quite the one planned for, whose
// motors stand elsewhere for the same q.
bool stands_as_learnt(const Trajectory& trajectory, const Sample& row) {
  const auto status = trajectory.metadata.find("status");
  bool still = status != trajectory.metadata.end() && status->second == kLearntStatus;
  for (std::size_t j = 0; j < kJoints; ++j) {
    still &= std::abs(row.state.dq[j]) <= kStill && std::abs(row.state.dtheta[j]) <= kStill;
  }
  return still;
}

Sample standing(const Parameters& planned_for, const Sample& row) {
  return {row.time, {row.state.q, {}, row.state.theta, {}}, spring_torque(planned_for, row.state.q, row.state.theta)};
}

Simulation roll_out(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory,
                    const Drive& drive) {
  Simulation out;
  Interpolator plan(trajectory);
  const auto record = [&](double time, const State<double>& x) {
    const Sample planned = plan.at(time);
    const Joints<double> feedback = drive.feedback(planned.state, x);
    const Joints<double> dither = drive.dither ? drive.dither->at(time) : Joints<double>{};
    out.samples.push_back({time, x, planned.torque});
    for (std::size_t j = 0; j < kJoints; ++j) out.samples.back().torque[j] += feedback[j] + dither[j];
  };
  Rollout rollout(arm, Limits{}, Accuracy::of_certificates());
  rollout.limit_step(longest_step(trajectory));
  const State<double> start = start_on(planned_for, arm, trajectory);
  rollout.start(trajectory.start_time(), start, drive);
  record(trajectory.start_time(), start);
  out.completed =
      rollout.run(trajectory.end_time(), comparison_instants(trajectory), torque_corners(trajectory, kCorner), record);
  out.failure = rollout.failure();
  return out;
}

void hold_after_end(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory, double duration,
                    Simulation& run) {
  const Sample& goal = trajectory.samples.back();
  const State<double> from = run.samples.back().state;
  const auto keep = [&](double after, const State<double>& x, const Joints<double>& torque) {
    run.samples.push_back({goal.time + after, x, torque});
  };
  run.completed = stands_as_learnt(trajectory, goal)
                      ? hold_at_place(planned_for, arm, standing(planned_for, goal), from, duration, keep)
                      : hold_at_rest(planned_for, arm, goal, from, duration, keep);
  if (!run.completed) run.failure = "the integration broke down after the end";
}

Simulation run_ticks(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory) {
  Simulation out;
  out.torque_held = true;
  const State<double> start = start_on(planned_for, arm, trajectory);
  out.samples.push_back({trajectory.start_time(), start, trajectory.samples.front().torque});
  out.completed = roll_out_ticks(planned_for, arm, trajectory, start, [&](const SimulatedTick& tick) {
    out.samples.push_back({tick.end, tick.state, tick.command.torque});
  });
  if (!out.completed) out.failure = "the integration broke down";
  return out;
}

}  // namespace

State<double> start_on(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory) {
  const Sample& first = trajectory.samples.front();
  if (stands_as_learnt(trajectory, first)) return {resting_with(arm, first.state.theta), {}, first.state.theta, {}};
  return is_at_rest(planned_for, first) ? rest_at(arm, first.state.q) : first.state;
}

bool stands(const Parameters& planned_for, const Trajectory& trajectory, const Sample& row) {
  return is_at_rest(planned_for, row) || stands_as_learnt(trajectory, row);
}

std::optional<Sample> held_after(const Parameters& planned_for, const Trajectory& trajectory) {
  const Sample& last = trajectory.samples.back();
  if (stands_as_learnt(trajectory, last)) return standing(planned_for, last);
  if (!is_at_rest(planned_for, last)) return std::nullopt;
  return Sample{last.time, rest_at(planned_for, last.state.q), gravity_torque(planned_for, last.state.q)};
}

Simulation simulate(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory,
                    ControlMode control, double hold) {
  Simulation run;
  if (control == ControlMode::kExecutor) {
    run = run_ticks(planned_for, arm, trajectory);
  } else {
    const bool open = control == ControlMode::kOpenLoop;
    run = roll_out(planned_for, arm, trajectory,
                   open ? Drive::open_loop(trajectory) : Drive::closed_loop(trajectory, planned_for));
  }
  if (hold > 0 && run.completed) hold_after_end(planned_for, arm, trajectory, hold, run);
  return run;
}

long tick_count(const Trajectory& trajectory) {
  const double ticks = (trajectory.end_time() - trajectory.start_time()) / kTick;
  return std::max(1L, static_cast<long>(std::ceil(ticks - 1e-9)));
}

bool roll_out_ticks(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory,
                    const State<double>& start, const std::function<void(const SimulatedTick&)>& observe) {
  State<double> x = start;
  TickController controller(planned_for, trajectory);
  Rollout rollout(arm, Limits{}, Accuracy::of_predictions());
  const double begin = trajectory.start_time(), end = trajectory.end_time();
  const long ticks = tick_count(trajectory);
  for (long k = 0; k < ticks; ++k) {
    const double now = begin + static_cast<double>(k) * kTick, next = std::min(end, now + kTick);
    const TickController::Command command = controller.command(now, {x.theta, x.q});
    if (k == 0) rollout.start(now, x, Drive::holding({now, {}, command.torque}));
    rollout.hold(command.torque);
    if (!rollout.run(next, {}, {}, {})) return false;
    x = rollout.state();
    observe({next, command, x});
  }
  return true;
}

}  // namespace fjr
