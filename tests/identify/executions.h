// Motions that the executor's own control tick ran on an arm that need not be the one planned for.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "common/parallel.h"
#include "planner/executor/control.h"
#include "planner/executor/execution_log.h"
#include "planner/executor/executor_config.h"
#include "planner/executor/virtual_arm.h"
#include "planner/identify/executed_motion.h"
#include "planner/protocol/messages.h"
#include "tests/executor/flat_motion.h"

namespace fjr {

inline const Parameters& robot() {
  static const Parameters p = load_parameters(default_robot_file());
  return p;
}

struct Move {
  Joints<double> from, to;
  double duration;
};
inline const std::vector<Move> kMoves{
    {{0, 0}, {1.2, -0.8}, 0.8}, {{1.2, -0.8}, {-0.5, 0.9}, 1.0}, {{-0.5, 0.9}, {0.4, 0.3}, 0.7}};

struct Executions {
  std::vector<Log> logs;
  std::vector<ExecutedMotion> motions;
  std::vector<ExecutionResult> results;
};

// An order of a client of its own: the log is named after it, and other tests write logs at the same time.
inline TrajectoryOrder order_of(const std::vector<Sample>& rows) {
  TrajectoryOrder order;
  order.id = new_client();
  order.id.number = 1;
  order.rows = rows;
  return order;
}

// The log of a motion that has ended, written and read; the file does not stay.
inline Log log_of(const CommandedMotion& motion, const ExecutionResult& result) {
  const std::filesystem::path file = write_log(motion, result, std::filesystem::temp_directory_path());
  Log log = read_log(file);
  std::filesystem::remove(file);
  return log;
}

// Plans for `planned_for`, one after the other, on the arm that there is.
inline Executions executed_on(VirtualArm& arm, const Parameters& planned_for, const std::vector<Trajectory>& plans) {
  Control control(planned_for, arm);
  const auto tick = [&](int count) {
    for (int i = 0; i < count; ++i) {
      control.tick();
      while (control.state()) {
      }
    }
  };
  tick(200);
  Executions all;
  for (const Trajectory& plan : plans) {
    const TrajectoryOrder order = order_of(plan.samples);
    Tolerances wide = ExecutorConfig{}.tolerances;
    wide.path = {0.5, 0.5};
    wide.goal = {0.5, 0.5};
    const auto motion = prepare_without_stops(planned_for, order, wide);
    EXPECT_TRUE(control.begin(motion.get()));
    for (int i = 0; i < 5000 && !control.finished(); ++i) tick(1);
    const ExecutionResult result = result_of(*motion, planned_for);
    EXPECT_EQ(result.code, ResultCode::kSuccessful) << result.sentence;
    all.logs.push_back(log_of(*motion, result));
    all.motions.push_back(executed_motion(all.logs.back()));
    all.results.push_back(result);
    tick(100);
  }
  return all;
}

// On one that begins where they do.
inline Executions executed(const Parameters& planned_for, const VirtualArmOptions& arm_options,
                           const std::vector<Trajectory>& plans) {
  VirtualArm arm(arm_options, plans.front().samples.front().state.q);
  return executed_on(arm, planned_for, plans);
}

// The same by flatness.
inline Executions executed(const Parameters& planned_for, const VirtualArmOptions& arm_options,
                           const std::vector<Move>& moves = kMoves) {
  std::vector<Trajectory> plans;
  for (const Move& move : moves) plans.push_back(flat_motion(planned_for, move.from, move.to, move.duration));
  return executed(planned_for, arm_options, plans);
}

inline Parameters wrong_arm() {
  Parameters truth = robot();
  for (std::size_t j = 0; j < kJoints; ++j) {
    truth.spring.stiffness[j] *= 0.95;
    truth.friction.viscous[j] *= 1.2;
  }
  truth.payload.mass = 0.1;
  return truth;
}

inline const ForEach kTwoThreads = [](std::size_t count, const std::function<void(std::size_t)>& task) {
  for_each_index(count, 2, task);
};

}  // namespace fjr
