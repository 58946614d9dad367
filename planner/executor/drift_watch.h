// Tests in the background, with the executed motions, whether the arm has drifted from the one in robot.yaml.
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

// Evaluates one motion after the other in a thread of lowest priority. Each takes some hundred rollouts, about as long
// as the motion itself. If motions arrive faster than that, the oldest waiting ones are dropped.
class DriftWatch {
 public:
  explicit DriftWatch(const Parameters& robot);
  ~DriftWatch();  // aborts the evaluation
  DriftWatch(const DriftWatch&) = delete;
  DriftWatch& operator=(const DriftWatch&) = delete;

  // Adds a motion that was executed to its end. Motions without information, such as those with missed ticks, are
  // ignored.
  void add(const CommandedMotion& motion);

  // Returns the state of the test if the evaluation of a motion has finished since the last call. Does not wait. The
  // caller has to fill in robot_id and robot_hash.
  std::optional<ArmDrift> look();

 private:
  struct Waiting {
    RequestId id;
    ExecutedMotion motion;
  };
  void begin_next();
  ArmDrift word() const;

  DriftTest test_;
  std::vector<RequestId> looked_at_;  // motions of the test so far, in its order
  std::deque<Waiting> waiting_;
  RequestId current_;
  std::stop_source unwanted_;
  std::future<std::optional<DriftTest::Look>> looking_;  // declared last: its destructor waits for the thread
};

}  // namespace fjr
