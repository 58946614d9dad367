// What the robot's executor says of itself: its epoch, and where the arm rests for requests that leave out their start.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <variant>

#include "planner/service/execution_messages.h"

namespace fjr {

class ExecutorWatch {
 public:
  using Clock = std::chrono::steady_clock;

  ExecutorWatch(std::string robot_id, std::string robot_hash);

  void heard(const ExecutorState& state);          // of any robot
  void lost(const std::string& robot_id);          // nobody speaks for it any more
  void published(const RequestId& trajectory_id);  // to be executed: it will move the arm

  std::uint64_t epoch() const { return state_ ? state_->epoch : 0; }
  bool runs_or_ran(const RequestId& trajectory_id) const;  // last

  // Link positions [rad] at rest, or one sentence on why there are none.
  std::variant<Pair<double>, std::string> rest() const;

 private:
  bool about_to_move() const;

  const std::string robot_id_, robot_hash_;
  std::optional<ExecutorState> state_;
  std::optional<RequestId> published_;
  Clock::time_point published_at_{};
};

}  // namespace fjr
