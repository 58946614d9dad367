// The next repetition of a motion, within the limits.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/certificate/task_of_motion.h"
#include "planner/learning/smoothed_run.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// A motion rolled out with the executor's law on one arm, until its last row.
struct Rehearsal {
  std::string arm;                  // "the model", "the model with the learnt torques"
  Joints<double> link_error{};      // [rad] of the links off the plan, largest
  Joints<double> link_error_rms{};  // [rad]
  std::vector<LimitCheck> limits;   // of rows and rollout, as in a certificate
  std::vector<TaskCheck> task;      // of the rollout, with the learnt torques only
  std::vector<std::string> broken;  // one sentence each; empty: all is kept
};

// What is known of a motion's repetitions beside its last run.
struct RepetitionHistory {
  std::optional<Joints<double>> motors_began;  // [rad] at the start of the run before the last one
  std::optional<double> refused_fraction;      // of the correction by the last run: an executor did not take it
};

struct Repetition {
  Trajectory rows;                    // to be executed next; where it was refused, those that were
  double fraction = 0;                // of the correction
  bool refused = false;               // not even an eighth of it may be executed
  Joints<double> link_error_rms{};    // [rad] of the last run, by its encoders; zero: nothing could be learnt from it
  Joints<double> motors_began{};      // [rad] at the start of the last run
  std::vector<Rehearsal> rehearsals;  // of the rows
  std::vector<std::string> reasons;   // against the next larger fraction; where it was refused, against the least
};

// From the rows that were executed and what was logged. Half of the correction is taken, a quarter, or an eighth, where
// with more of it rows or rollouts break a limit or the task, or the arm with the learnt torques follows the plan worse
// than it did. Rollouts: of the robot's model, which has to keep the limits whatever was learnt, and of the model with
// the learnt torques, which has to keep the task too, but for what a count of the links' encoders makes.
// Of a run in which both links were within a count rms nothing is learnt: the rows are executed again. Less is taken of
// a correction than an executor has refused.
// limits: the robot's or tighter ones. Throws InputError as smoothed_run() and correction_after() do.
Repetition next_repetition(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                           const Trajectory& executed, const ExecutedMotion& motion,
                           const RepetitionHistory& history = {});

// What either rehearsal breaks, one sentence each; empty: the rows may be executed. Also of those of a repetition that
// was refused.
std::vector<std::string> broken_in(const Repetition& repetition);

// Rows that were learnt, on the robot's model, until the last of them. It rests at first with its motors where the rows
// begin, as the arm has to. They are of the shape of a trajectory
// (malformed(), consistency.h).
Rehearsal rehearsal_on_model(const Parameters& robot, const Limits& limits, const Trajectory& rows);

// Throws InputError naming the log, the column and the row where the log is not of a run of these rows: where the
// plan in it is another, or where it does not cover the motion, to a tick of the executor. rows_name: of the rows, for
// the message.
void require_run_of(const Trajectory& rows, const std::string& rows_name, const Log& log);

}  // namespace fjr
