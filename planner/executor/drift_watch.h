// Whether the arm is still the one of robot.yaml, looked at beside the executor's work.
#pragma once

#include <deque>
#include <future>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "planner/executor/motion.h"
#include "planner/identify/drift.h"
#include "planner/protocol/execution_messages.h"

namespace fjr {

// One motion after the other, each in a thread of the least priority; what it tells is some hundred rollouts, about as
// long as the motion. Where motions come faster than that, the oldest of more than a few is left out.
class DriftWatch {
 public:
  explicit DriftWatch(const Parameters& robot);
  ~DriftWatch();  // ends what is looked at
  DriftWatch(const DriftWatch&) = delete;
  DriftWatch& operator=(const DriftWatch&) = delete;

  // What was executed to its end. Motions that tell nothing, as those with missed ticks, are left out.
  void add(const CommandedMotion& motion);

  // What is known since the last call; nothing where no motion was concluded meanwhile. robot_id and robot_hash are the
  // caller's to fill. Does not wait.
  std::optional<ArmDrift> look();

 private:
  struct Waiting {
    RequestId id;
    ExecutedMotion motion;
  };
  void begin_next();
  ArmDrift word() const;

  DriftTest test_;
  std::vector<RequestId> looked_at_;  // in the order of the test's motions
  std::deque<Waiting> waiting_;
  RequestId current_;
  std::stop_source unwanted_;
  std::future<std::optional<DriftTest::Look>> looking_;  // last: waits for the thread
};

}  // namespace fjr
