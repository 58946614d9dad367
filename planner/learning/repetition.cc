#include "planner/learning/repetition.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "common/input_error.h"
#include "planner/certificate/comparison.h"
#include "planner/certificate/consistency.h"
#include "planner/certificate/limits.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/ticks.h"
#include "planner/control/motor_feedback.h"
#include "planner/learning/correction.h"
#include "planner/problem/quantities.h"

namespace fjr {
namespace {

constexpr std::array kFractions{1.0, 0.5, 0.25, 0.125};
constexpr double kSamePlan = 1e-8;  // [rad] allowed difference, as the log has twelve digits
constexpr double kSameTime = 1e-6;  // [s] likewise

// Collects errors and checks of limits during a rollout, tick by tick.
class Rehearsed {
 public:
  Rehearsed(const Parameters& robot, const TaskOfMotion* task, const Trajectory& rows)
      : robot_(robot), task_(task), plan_(rows) {
    if (task_ == nullptr || task_->empty()) return;
    for (const TaskRow& row : task_->rows.front())
      checks_.push_back({row.name, row.link, row.unit(), kNoLimit, 0, true});
  }

  void add(double time, const State<double>& x, const TickController::Command& command) {
    raise(comparison_.peaks, {robot_, x, command.torque, {}}, [](const QuantityInfo&) { return true; });
    const Joints<double> wanted = plan_.at(time).state.q;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double error = std::abs(x.q[j] - wanted[j]);
      link_error_[j] = std::max(link_error_[j], error);
      squares_[j] += error * error;
      if (command.saturated && !saturated_at_) saturated_at_ = time;
    }
    ++ticks_;
    for (std::size_t r = 0; r < checks_.size(); ++r) look_at_task(r, time, x);
  }

  Rehearsal finish(std::string arm, const Limits& limits, const Trajectory& rows, const Rollout& rollout) {
    comparison_.events = rollout.events();
    Rehearsal result{std::move(arm), link_error_, {}, check_limits(robot_, limits, rows, comparison_), checks_, {}};
    for (std::size_t j = 0; j < kJoints; ++j) {
      result.link_error_rms[j] = std::sqrt(squares_[j] / static_cast<double>(std::max(1L, ticks_)));
    }
    for (const LimitCheck& check : result.limits) {
      if (!check.passed) result.broken.push_back(violation(check, limits));
    }
    for (const TaskCheck& check : result.task) {
      if (check.passed) continue;
      result.broken.push_back(
          fmt::format("{} is missed by {:.3g} {} at {:.3f} s", check.name, -check.clearance, check.unit, check.time));
    }
    if (saturated_at_) {
      result.broken.push_back(
          fmt::format("the drives' peak torque is reached at {:.3f} s, with the executor's feedback", *saturated_at_));
    }
    if (!rollout.failure().empty()) result.broken.push_back(rollout.failure());
    return result;
  }

 private:
  void look_at_task(std::size_t r, double time, const State<double>& x) {
    const TaskRow& row = task_->rows[task_->segment_at(time)][r];
    const double clearance = row.distance(row.value(robot_, Posture<double>::of(robot_, x.q)));
    TaskCheck& check = checks_[r];
    if (clearance < check.clearance) {
      check.clearance = clearance;
      check.time = time;
    }
    check.passed = check.clearance >= -moved_by(robot_, row, exactness_tolerance(robot_));
  }

  const Parameters& robot_;
  const TaskOfMotion* task_;
  Interpolator plan_;
  Comparison comparison_;
  Joints<double> link_error_{}, squares_{};
  long ticks_ = 0;
  std::optional<double> saturated_at_;  // [s]
  std::vector<TaskCheck> checks_;
};

// Simulates the samples with the executor's control law. run: its lacking torques act on the model; null: none act.
Rehearsal rehearse(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& rows,
                   const State<double>& start, const SmoothedRun* run) {
  Rehearsed figures(robot, run == nullptr ? nullptr : &task, rows);
  TickController controller(robot, rows);
  Rollout rollout(robot, rollout_allowance(robot, limits), Accuracy::of_certificates());
  State<double> x = start;
  const double begin = rows.start_time(), end = rows.end_time();
  for (long k = 0; k < tick_count(rows); ++k) {
    const double now = begin + static_cast<double>(k) * kTick, next = std::min(end, now + kTick);
    const TickController::Command command = controller.command(now, {x.theta, x.q});
    const LackingTorques lacking = run == nullptr ? LackingTorques{} : run->lacking_at(0.5 * (now + next));
    if (k == 0) rollout.start(now, x, Drive::holding({now, {}, command.torque}));
    rollout.push_links(lacking.link);
    rollout.hold({command.torque[0] + lacking.motor[0], command.torque[1] + lacking.motor[1]});
    if (!rollout.run(next, {}, {}, {})) break;
    x = rollout.state();
    figures.add(next, x, command);
  }
  return figures.finish(run == nullptr ? "the model" : "the model with the learnt torques", limits, rows, rollout);
}

// Returns the reasons why these samples must not be executed; empty if there are none.
std::vector<std::string> against(const Parameters& robot, const Repetition& repetition) {
  if (const auto malformation = malformed(repetition.rows)) return {*malformation};
  std::vector<std::string> reasons = broken_in(repetition);
  const Joints<double>& expected = repetition.rehearsals.back().link_error_rms;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double count = exactness_tolerance(robot);
    if (expected[j] <= repetition.link_error_rms[j] + count) continue;
    reasons.push_back(fmt::format("link {} would be off the plan by {:.3g} counts rms, after {:.3g}", j + 1,
                                  expected[j] / count, repetition.link_error_rms[j] / count));
  }
  return reasons;
}

bool within_a_count(const Parameters& robot, const ExecutedMotion& motion) {
  return std::max(motion.link_error_rms[0], motion.link_error_rms[1]) <= exactness_tolerance(robot);
}

// A log of ticks has its first row within a tick of the motion's start, and its last one within a tick of its end.
void require_whole(const Trajectory& rows, const Log& log) {
  const std::vector<double>& times = log.column("time");
  const double begin = rows.start_time(), end = rows.end_time();
  if (times.front() > begin + kTick + kSameTime) {
    throw InputError(log.source, "time, row 1",
                     fmt::format("{:.9g} s, but the motion begins at {:.9g} s: its log begins at most a tick of {:g} s "
                                 "later",
                                 times.front(), begin, kTick));
  }
  if (times.back() < end - kTick - kSameTime) {
    throw InputError(log.source, fmt::format("time, row {}", times.size()),
                     fmt::format("{:.9g} s is the last one, but the motion ends at {:.9g} s: its log ends at most a "
                                 "tick of {:g} s earlier",
                                 times.back(), end, kTick));
  }
}

}  // namespace

Repetition next_repetition(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                           const Trajectory& executed, const ExecutedMotion& motion, const RepetitionHistory& history) {
  const SmoothedRun run = smoothed_run(robot, motion);
  const Correction correction = correction_after(robot, executed, run, history.motors_began);
  const auto with = [&](double fraction) {
    Repetition r{fraction > 0 ? corrected(executed, correction, fraction) : executed,
                 fraction,
                 false,
                 motion.link_error_rms,
                 run.states.front().theta,
                 {},
                 {}};
    r.rehearsals.push_back(rehearsal_on_model(robot, limits, r.rows));
    r.rehearsals.push_back(rehearse(robot, limits, task, r.rows, correction.start, &run));
    return r;
  };
  if (within_a_count(robot, motion)) {
    Repetition same = with(0);
    same.reasons.emplace_back("both links were within a count rms of the plan: nothing is left to learn but noise");
    return same;
  }
  std::vector<std::string> reasons;
  for (const double fraction : kFractions) {
    if (history.refused_fraction && fraction >= *history.refused_fraction) {
      reasons = {fmt::format("the executor has refused {:g} of the correction", fraction)};
      continue;
    }
    Repetition repetition = with(fraction);
    std::vector<std::string> why_not = against(robot, repetition);
    if (why_not.empty()) {
      repetition.reasons = std::move(reasons);
      return repetition;
    }
    reasons = std::move(why_not);
  }
  Repetition refused = with(0);
  refused.refused = true;
  refused.reasons = std::move(reasons);
  return refused;
}

std::vector<std::string> broken_in(const Repetition& repetition) {
  std::vector<std::string> sentences;
  std::set<std::string> told;  // what the rows themselves break appears for both arms, and is told once
  for (const Rehearsal& rehearsal : repetition.rehearsals) {
    for (const std::string& broken : rehearsal.broken) {
      if (told.insert(broken).second) sentences.push_back(rehearsal.arm + ": " + broken);
    }
  }
  return sentences;
}

Rehearsal rehearsal_on_model(const Parameters& robot, const Limits& limits, const Trajectory& rows) {
  const Joints<double>& motors = rows.samples.front().state.theta;
  return rehearse(robot, limits, {}, rows, {resting_with(robot, motors), {}, motors, {}}, nullptr);
}

void require_run_of(const Trajectory& rows, const std::string& rows_name, const Log& log) {
  Interpolator plan(rows);
  const std::vector<double>& times = log.column("time");
  for (std::size_t j = 0; j < kJoints; ++j) {
    for (const bool of_motor : {false, true}) {
      const std::string name = joint_column(of_motor ? "theta" : "q", static_cast<int>(j), "_plan");
      const std::vector<double>& logged = log.column(name);
      for (std::size_t i = 0; i < times.size() && times[i] <= rows.end_time(); ++i) {
        const State<double> x = plan.at(times[i]).state;
        const double planned = (of_motor ? x.theta : x.q)[j];
        if (std::abs(logged[i] - planned) <= kSamePlan) continue;
        throw InputError(log.source, fmt::format("{}, row {}", name, i + 1),
                         fmt::format("{:.9g} rad, where {} has {:.9g} rad: it is not the log of that motion", logged[i],
                                     rows_name, planned));
      }
    }
  }
  require_whole(rows, log);
}

}  // namespace fjr
