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
#include "planner/certificate/residual.h"
#include "planner/control/motor_feedback.h"
#include "planner/learning/repetition.h"
#include "planner/stop/stop_motion.h"

namespace fjr {
namespace {

constexpr double kLongestAfter = 3;  // [s] logged after the end of the motion or of a stop

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

// Returns the samples followed by rest at the goal. The torque of the last sample still brakes; after it the goal is
// held by the torque in the springs. That is the gravity torque, unless the motion was learnt on an arm that differs
// from the model.
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
    case Ending::kEncoderLost:  // whether it stayed within the path tolerance is unknown
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

// Judges a planned motion. After its last row the arm is held by the torque of the springs, so the springs must balance
// gravity there: links that only turn back there would be thrown off the goal.
void judge(const Parameters& robot, const Trajectory& plan) {
  std::vector<std::string> faults = judge_closed_loop(robot, Limits::of(robot), plan).failures;
  const Sample& last = plan.samples.back();
  if (!is_at_rest(robot, last)) {
    const Joints<double> rest = rest_at(robot, last.state.q).theta;
    faults.push_back(fmt::format(
        "does not end at rest: its last row has theta = ({:.6g}, {:.6g}) rad and dtheta = ({:.2g}, {:.2g}) rad/s, "
        "where gravity and springs are in balance with ({:.6g}, {:.6g}) rad",
        last.state.theta[0], last.state.theta[1], last.state.dtheta[0], last.state.dtheta[1], rest[0], rest[1]));
  }
  refuse_for(faults);
}

// Judges a learnt motion. It is made for an arm that differs from the model, so on the model its links deviate from the
// plan by design. In case the arm is the model after all, the motion must keep the model's limits, and its links must
// stay close to the plan: so close that an arm that was at the path tolerance on one side when the motion was learnt
// does not leave the tolerance on the other side. The rest at the goal is included, because it is held as it was
// learnt.
void judge_learnt(const Parameters& robot, Trajectory rows, const Tolerances& tolerances) {
  if (const auto fault = malformed(rows)) refuse_for({*fault});
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
  if (stops.over() && stops.fault()) throw NoStop(*stops.fault());
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
  // Touch the memory of the log here. If the tick touched a page first, it would have to wait for the kernel.
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
  if (brings_stops) begin_to_check(robot, plan, *motion);  // runs concurrently with the judgement
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
    const bool fault = motion.stops->over() && motion.stops->fault();
    result.sentence += fault ? ": " + *motion.stops->fault() : ", for the next was not checked in time";
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
  if (run.rows.size() > kMaxRows) run.rows.resize(kMaxRows);  // the rest is long after the motion, waiting for the goal
  return run;
}

}  // namespace fjr
