// Runs what it receives on an arm: one thread, one control tick a millisecond.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "planner/executor/acceptance.h"
#include "planner/executor/arm.h"
#include "planner/executor/dds/executor_port.h"
#include "planner/executor/execution.h"

namespace fjr {

struct ExecutorConfig {
  unsigned domain = 0;
  std::string robot_id = "arm";
  bool fast = false;  // while executing, ticks follow each other without waiting for the clock
};

class Executor {
 public:
  Executor(const ExecutorConfig& config, const Parameters& robot, Arm& arm);

  void run();                        // until stop()
  void stop() { stopping_ = true; }  // from any thread

 private:
  void take_orders();
  void consider(TrajectoryOrder order);
  void tick();
  void conclude(const ExecutionResult& result);

  const ExecutorConfig config_;
  const Parameters robot_;
  Arm& arm_;
  dds::ExecutorPort port_;
  Situation situation_;
  RequestId trajectory_id_;
  std::unique_ptr<Execution> execution_;  // never none: at least it rests
  bool concluded_ = true;
  std::atomic<bool> stopping_ = false;
};

}  // namespace fjr
