// Computes the next repetition of a motion with a learnt correction that keeps the limits.
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

// The result of simulating a motion with the executor's control law on one arm, until its last sample.
struct Rehearsal {
  std::string arm;                  // "the model", "the model with the learnt torques"
  Joints<double> link_error{};      // [rad] largest deviation of the links from the plan
  Joints<double> link_error_rms{};  // [rad]
  std::vector<LimitCheck> limits;   // of rows and rollout, as in a certificate
  std::vector<TaskCheck> task;      // of the rollout, with the learnt torques only
  std::vector<std::string> broken;  // one sentence per violation; empty if there is none
};

// What is known about earlier repetitions of a motion.
struct RepetitionHistory {
  std::optional<Joints<double>> motors_began;  // [rad] at the start of the run before the last one
  std::optional<double> refused_fraction;      // fraction of the last correction that an executor refused
};

struct Repetition {
  Trajectory rows;                    // to be executed next; if `refused`, the old ones
  double fraction = 0;                // of the correction that was applied
  bool refused = false;               // not even an eighth of the correction may be executed
  Joints<double> link_error_rms{};    // [rad] of the last run, by its encoders; zero: nothing could be learnt from it
  Joints<double> motors_began{};      // [rad] at the start of the last run
  std::vector<Rehearsal> rehearsals;  // of the rows
  std::vector<std::string> reasons;   // against the next larger fraction; if `refused`, against the smallest
};

// Computes the next repetition from the executed samples and the log. It applies the whole correction, or a half, a
// quarter or an eighth of it if more would violate a limit or the task, or if the arm with the learnt torques would
// follow the plan worse than it did. That is checked by two rollouts: of the robot's model, which must keep the limits
// whatever was learnt, and of the model with the learnt torques, which must also keep the task (to within a count of
// the link encoders). If both links were within one count rms in the run, nothing is learnt and the same samples are
// executed again. The fraction stays below one that an executor has refused. limits: those of the robot or tighter
// ones. Throws InputError as smoothed_run() and correction_after() do.
Repetition next_repetition(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                           const Trajectory& executed, const ExecutedMotion& motion,
                           const RepetitionHistory& history = {});

// Returns the violations in either rehearsal, one sentence each; empty if the samples may be executed. It works for
// refused repetitions, too.
std::vector<std::string> broken_in(const Repetition& repetition);

// Simulates learnt samples on the robot's model. The model begins at rest with its motors where the samples begin, as
// the arm must. The samples must be well-formed (malformed(), consistency.h).
Rehearsal rehearsal_on_model(const Parameters& robot, const Limits& limits, const Trajectory& rows);

// Throws InputError, naming the log, the column and the row, if the log is not from a run of these samples: if it
// contains another plan, or does not cover the whole motion to a tick. rows_name: name of the samples for the message.
void require_run_of(const Trajectory& rows, const std::string& rows_name, const Log& log);

}  // namespace fjr
