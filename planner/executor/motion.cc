#include "planner/executor/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "planner/certificate/certificate.h"
#include "planner/certificate/consistency.h"
#include "planner/certificate/judge.h"
#include "planner/control/motor_feedback.h"
#include "planner/learning/repetition.h"
#include "planner/stop/stop_motion.h"

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

// The last row's torque still brakes; from there on the goal is held by what the springs have to hold there, which is
// its gravity torque unless the motion was learnt on an arm that is not quite the model.
Trajectory with_rest_after(const Parameters& robot, const std::vector<Sample>& rows) {
  Trajectory trajectory{rows, {}};
  const State<double>& goal = rows.back().state;
  trajectory.samples.push_back(
      {rows.back().time + kJumpSpacing, {goal.q, {}, goal.theta, {}}, spring_torque(robot, goal.q, goal.theta)});
  return trajectory;
}

ResultCode code_of(Ending ending) {
  switch (ending) {
    case Ending::kReached:
      return ResultCode::kSuccessful;
    case Ending::kPathTolerance:
    case Ending::kEncoderLost:  // nobody can say that it kept to the path
    case Ending::kStalled:
    case Ending::kNoStop:
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
    case Ending::kNoStop:
      return fmt::format("no checked stop motion was there from {:.3f} s on", o.time);
    case Ending::kNotBegun:
      return "held, stopped or moved before it could begin";
    case Ending::kShutDown:
      return fmt::format("the executor was ended at {:.3f} s", o.time);
  }
  return "";
}

void refuse_for(const std::vector<std::string>& faults) {
  if (!faults.empty()) throw RowsRefused(fmt::format("{}", fmt::join(faults, "; ")));
}

void judge(const Parameters& robot, const Trajectory& plan) {
  refuse_for(judge_closed_loop(robot, Limits::of(robot), plan).failures);
}

// Learnt rows are made for an arm that is not quite the model, on which their links leave the plan by design. But
// should the arm be the model after all, they keep its limits, and the links stay so near to the plan that not even an
// arm that was at the tolerance on one side of it when they were learnt would leave it on the other one.
// The rest at the goal counts, for it is held as it was learnt.
void judge_learnt(const Parameters& robot, Trajectory rows, const Tolerances& tolerances) {
  if (const std::string fault = malformed(rows); !fault.empty()) refuse_for({fault});
  rows = with_rest_after(robot, rows.samples);
  rows.samples.push_back(rows.samples.back());
  rows.samples.back().time += kWatched;
  const Rehearsal on_model = rehearsal_on_model(robot, Limits::of(robot), rows);
  refuse_for(on_model.broken);
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double allowed = 2 * tolerances.path[j];
    if (on_model.link_error[j] <= allowed) continue;
    refuse_for(
        {fmt::format("learnt for another arm: as robot.yaml has it, link {} would leave the plan by {:.3g} rad, "
                     "twice the path tolerance is {:.3g} rad",
                     j + 1, on_model.link_error[j], allowed)});
  }
}

void begin_to_check(const Parameters& robot, const Trajectory& plan, CommandedMotion& motion) {
  const std::vector<StopMotion>& stops = motion.order.stops;
  if (stops.size() != count_of_stops(plan)) {
    throw std::runtime_error(fmt::format("brings {} stop motions; one every {:g} s are {}", stops.size(), kStopSpacing,
                                         count_of_stops(plan)));
  }
  motion.stops.emplace(robot, plan, stops);
}

void continue_if_wanted(const std::stop_token& unwanted) {
  if (unwanted.stop_requested()) throw std::runtime_error("held or stopped before it could begin");
}

void await_lead(const CheckedStops& stops, double lead, const std::stop_token& unwanted) {
  const double wanted = std::min(static_cast<double>(stops.size()), std::ceil(lead / kStopSpacing));
  while (!stops.over() && static_cast<double>(stops.usable()) < wanted) {
    continue_if_wanted(unwanted);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  if (stops.over() && !stops.fault().empty()) throw NoStop(stops.fault());
  continue_if_wanted(unwanted);
}

}  // namespace

std::unique_ptr<CommandedMotion> prepare_without_stops(const Parameters& robot, TrajectoryOrder order,
                                                       const Tolerances& defaults) {
  auto motion = std::make_unique<CommandedMotion>();
  motion->end = order.rows.back().time;
  motion->trajectory = with_rest_after(robot, order.rows);
  motion->tolerances = resolved(order.tolerances, defaults);
  const double longest = motion->end + motion->tolerances.goal_time + kLongestAfter;
  // Touched here: a page that the tick is the first to touch has it wait for whoever changes the memory map.
  motion->log.resize(static_cast<std::size_t>(longest / kTick));
  motion->log.clear();
  motion->order = std::move(order);
  return motion;
}

std::unique_ptr<CommandedMotion> prepare(const Parameters& robot, TrajectoryOrder order, const Tolerances& defaults,
                                         double lead, const std::stop_token& unwanted) {
  auto motion = prepare_without_stops(robot, std::move(order), defaults);
  const Trajectory plan{motion->order.rows, {}};
  std::vector<StopMotion>& stops = motion->order.stops;
  const bool brings_stops = !stops.empty();
  if (brings_stops) begin_to_check(robot, plan, *motion);  // beside the judgement
  motion->order.learnt ? judge_learnt(robot, plan, motion->tolerances) : judge(robot, plan);
  if (!brings_stops) {
    stops = stop_motions(robot, plan, [&] { continue_if_wanted(unwanted); });
    begin_to_check(robot, plan, *motion);
  }
  await_lead(*motion->stops, lead, unwanted);
  return motion;
}

ExecutionResult result_of(const CommandedMotion& motion, const Parameters& robot) {
  const Outcome& outcome = motion.outcome;
  ExecutionResult result;
  result.robot_id = motion.order.robot_id;
  result.trajectory_id = motion.order.id;
  result.code = code_of(outcome.ending);
  result.sentence = reason_of(outcome);
  if (outcome.ending == Ending::kNoStop) {
    const bool fault = motion.stops->over() && !motion.stops->fault().empty();
    result.sentence += fault ? ": " + motion.stops->fault() : ", for the next was not checked in time";
  }
  if (outcome.ending == Ending::kReached || outcome.ending == Ending::kNotBegun) {
    if (outcome.ending == Ending::kReached) motion.figures.fill(result, robot);
    return result;
  }
  result.sentence += fmt::format("; held at q = ({:.4f}, {:.4f}) rad", motion.ended_at[0], motion.ended_at[1]);
  motion.figures.fill(result, robot);
  return result;
}

std::vector<ExecutedRow> ticks_of(const CommandedMotion& motion) {
  std::vector<ExecutedRow> ticks;
  ticks.reserve(motion.log.size());
  for (const LogRow& row : motion.log) {
    ticks.push_back({row.time, row.q, row.theta, row.torque, row.planned.state.q, row.planned.state.theta});
  }
  return ticks;
}

ExecutedRun run_of(const CommandedMotion& motion, const ExecutionResult& result) {
  ExecutedRun run;
  run.robot_id = result.robot_id;
  run.robot_hash = motion.order.robot_hash;
  run.trajectory_id = result.trajectory_id;
  run.code = result.code;
  run.sentence = result.sentence;
  run.missed_ticks = static_cast<std::uint32_t>(motion.missed_ticks);
  run.rows = ticks_of(motion);
  if (run.rows.size() > kMaxRows) run.rows.resize(kMaxRows);  // long after the motion: it waits for the goal
  return run;
}

}  // namespace fjr
