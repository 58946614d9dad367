// One goal on its way through the planning service and the executor, in a thread of its own.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "planner/protocol/network.h"
#include "planner/ros2/goal_request.h"

namespace fjr {

struct GoalOutcome {
  GoalStatus status = GoalStatus::kAborted;
  FollowResult result;
};

class GoalExecution {
 public:
  struct Where {
    Network network;
    std::string robot_id;
  };

  // wake: called from the thread whenever there is something to take.
  GoalExecution(const Where& where, std::string name, GoalRequest request, std::function<void()> wake);
  ~GoalExecution();  // cancels, and waits until the arm rests or nobody answers
  GoalExecution(const GoalExecution&) = delete;
  GoalExecution& operator=(const GoalExecution&) = delete;

  void cancel() { cancelled_ = true; }
  std::optional<FollowFeedback> take_feedback();  // the latest
  std::optional<GoalOutcome> take_outcome();      // comes once, and is the last

 private:
  void run();
  GoalOutcome outcome();
  GoalOutcome executed(const ExecutionResult& result) const;
  void follow(double time, const ExecutorState& state);

  const Where where_;
  const std::string name_;
  const GoalRequest request_;
  const std::function<void()> wake_;
  std::atomic<bool> cancelled_ = false;
  std::optional<FollowResult> strayed_;  // of the thread
  double told_ = 0;                      // [s] within the motion, when feedback was last given; of the thread
  std::mutex mutex_;
  std::optional<FollowFeedback> feedback_;
  std::optional<GoalOutcome> outcome_;
  std::jthread thread_;
};

}  // namespace fjr
