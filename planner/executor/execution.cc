#include "planner/executor/execution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fjr {
namespace {

// The last row's torque still brakes; from there on the goal is held by its own gravity torque.
Trajectory with_rest_after(const std::vector<Sample>& rows, const Parameters& robot) {
  Trajectory trajectory{rows, {}};
  const Pair<double> goal = rows.back().state.q;
  trajectory.samples.push_back({rows.back().time + kJumpSpacing, rest_at(robot, goal), gravity_torque(robot, goal)});
  return trajectory;
}

double tolerance(double given, double standard) { return given > 0 ? given : standard; }

}  // namespace

Execution::Execution(const Parameters& robot, TrajectoryOrder order)
    : order_(std::move(order)),
      end_(order_.rows.back().time),
      trajectory_(with_rest_after(order_.rows, robot)),
      plan_(trajectory_),
      controller_(robot, trajectory_) {
  so_far_.robot_id = order_.robot_id;
  so_far_.trajectory_id = order_.id;
}

TrajectoryOrder Execution::rest(const Parameters& robot, const Pair<double>& q) {
  const Sample row{0, rest_at(robot, q), gravity_torque(robot, q)};
  Sample later = row;
  later.time = kTick;
  TrajectoryOrder order;
  order.rows = {row, later};
  return order;
}

void Execution::tick(Arm& arm) {
  const double now = trajectory_.start_time() + static_cast<double>(ticks_++) * kTick;
  const TickController::Command command = controller_.command(now, arm.motor_positions());
  arm.command(command.torque);
  const Pair<double> q = arm.link_positions(), planned = plan_.at(now + kTick).state.q;
  state_.time = now + kTick;
  state_.q = q;
  state_.theta = arm.motor_positions();
  state_.planned_q = planned;
  state_.torque = command.torque;
  state_.feedback = command.feedback;
  if (result_) return;
  for (std::size_t j = 0; j < kJoints; ++j) {
    so_far_.feedback_torque[j] = std::max(so_far_.feedback_torque[j], std::abs(command.feedback[j]));
  }
  judge({q[0] - planned[0], q[1] - planned[1]});
}

void Execution::judge(const Pair<double>& error) {
  const bool moving = state_.time <= end_;
  measured_ += moving ? 1 : 0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double size = std::abs(error[j]);
    if (moving) {
      so_far_.link_error[j] = std::max(so_far_.link_error[j], size);
      so_far_.link_error_rms[j] += size * size;
    } else {
      so_far_.residual_vibration[j] = std::max(so_far_.residual_vibration[j], size);
    }
    so_far_.final_link_error[j] = size;
    const double path = tolerance(order_.tolerances.path[j], kPathTolerance);
    if (!(size <= path)) {
      return end(ResultCode::kPathToleranceViolated,
                 fmt::format("link {} was {:.3g} rad off the plan at {:.3f} s, {:.3g} rad are allowed", j + 1, size,
                             state_.time, path));
    }
  }
  if (state_.time < end_ + tolerance(order_.tolerances.goal_time, kGoalTime)) return;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double goal = tolerance(order_.tolerances.goal[j], kGoalTolerance);
    if (!(std::abs(error[j]) <= goal)) {
      return end(ResultCode::kGoalToleranceViolated,
                 fmt::format("link {} ended {:.3g} rad off the goal, {:.3g} rad are "
                             "allowed",
                             j + 1, std::abs(error[j]), goal));
    }
  }
  end(ResultCode::kSuccessful, "");
}

void Execution::end(ResultCode code, const std::string& sentence) {
  result_ = so_far_;
  result_->code = code;
  result_->sentence = sentence;
  for (double& rms : result_->link_error_rms) rms = std::sqrt(rms / static_cast<double>(std::max(1L, measured_)));
}

}  // namespace fjr
