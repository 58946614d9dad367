#include "planner/executor/motion.h"

#include <fmt/format.h>

#include "planner/certificate/tracking.h"
#include "planner/executor/stop_motion.h"

namespace fjr {
namespace {

constexpr double kLongestAfter = 3;  // [s] beyond the end of the motion or of a stop that is logged

double given_or(double given, double standard) { return given > 0 ? given : standard; }

Tolerances resolved(const Tolerances& given, const Tolerances& standard) {
  Tolerances t;
  for (std::size_t j = 0; j < kJoints; ++j) {
    t.path[j] = given_or(given.path[j], standard.path[j]);
    t.goal[j] = given_or(given.goal[j], standard.goal[j]);
    t.stopped_velocity[j] = given_or(given.stopped_velocity[j], standard.stopped_velocity[j]);
  }
  t.goal_time = given_or(given.goal_time, standard.goal_time);
  return t;
}

// The last row's torque still brakes; from there on the goal is held by its own gravity torque.
Trajectory with_rest_after(const Parameters& robot, const std::vector<Sample>& rows) {
  Trajectory trajectory{rows, {}};
  const Pair<double> goal = rows.back().state.q;
  trajectory.samples.push_back({rows.back().time + kJumpSpacing, rest_at(robot, goal), gravity_torque(robot, goal)});
  return trajectory;
}

ResultCode code_of(Ending ending) {
  switch (ending) {
    case Ending::kReached:
      return ResultCode::kSuccessful;
    case Ending::kPathTolerance:
    case Ending::kEncoderLost:  // nobody can say that it kept to the path
    case Ending::kStalled:
      return ResultCode::kPathToleranceViolated;
    case Ending::kNotBegun:
      return ResultCode::kInvalidGoal;
    case Ending::kGoalTolerance:
    case Ending::kCommanded:
    case Ending::kShutDown:
      break;
  }
  return ResultCode::kGoalToleranceViolated;  // it rests, but not at the goal
}

std::string reason_of(const Outcome& o) {
  switch (o.ending) {
    case Ending::kReached:
      return "";
    case Ending::kPathTolerance:
      return fmt::format("link {} was {:.3g} rad off the plan at {:.3f} s, {:.3g} rad are allowed", o.joint, o.value,
                         o.time, o.allowed);
    case Ending::kGoalTolerance:
      return fmt::format("link {} was still {:.3g} {} at {:.3f} s, {:.3g} are allowed", o.joint, o.value, o.what,
                         o.time, o.allowed);
    case Ending::kCommanded:
      return fmt::format("{} was commanded at {:.3f} s", o.what, o.time);
    case Ending::kEncoderLost:
      return fmt::format("the encoder {} gave no more samples at {:.3f} s", o.what, o.time);
    case Ending::kStalled:
      return fmt::format("{} control ticks in a row were missed at {:.3f} s", o.value, o.time);
    case Ending::kNotBegun:
      return "held, stopped or moved before it could begin";
    case Ending::kShutDown:
      return fmt::format("the executor was ended at {:.3f} s", o.time);
  }
  return "";
}

}  // namespace

std::unique_ptr<CommandedMotion> prepare_without_stops(const Parameters& robot, TrajectoryOrder order,
                                                       const Tolerances& defaults) {
  auto motion = std::make_unique<CommandedMotion>();
  motion->end = order.rows.back().time;
  motion->trajectory = with_rest_after(robot, order.rows);
  motion->tolerances = resolved(order.tolerances, defaults);
  const double longest = motion->end + motion->tolerances.goal_time + kLongestAfter;
  motion->log.reserve(static_cast<std::size_t>(longest / kTick));
  motion->order = std::move(order);
  return motion;
}

std::unique_ptr<CommandedMotion> prepare(const Parameters& robot, TrajectoryOrder order, const Tolerances& defaults,
                                         const std::function<void()>& between) {
  auto motion = prepare_without_stops(robot, std::move(order), defaults);
  motion->stops = stop_motions(robot, Trajectory{motion->order.rows, {}}, between);
  return motion;
}

ExecutionResult result_of(const CommandedMotion& motion, const Parameters& robot) {
  const Outcome& outcome = motion.outcome;
  ExecutionResult result;
  result.robot_id = motion.order.robot_id;
  result.trajectory_id = motion.order.id;
  result.code = code_of(outcome.ending);
  result.sentence = reason_of(outcome);
  if (outcome.ending == Ending::kReached || outcome.ending == Ending::kNotBegun) {
    if (outcome.ending == Ending::kReached) motion.figures.fill(result, robot);
    return result;
  }
  result.sentence += fmt::format("; held at q = ({:.4f}, {:.4f}) rad", motion.ended_at[0], motion.ended_at[1]);
  motion.figures.fill(result, robot);
  return result;
}

}  // namespace fjr
