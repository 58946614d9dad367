// What the robot's executor says of itself: its epoch, and where the arm rests for requests that leave out their start.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "planner/protocol/execution_messages.h"
#include "planner/protocol/stamp_clock.h"

namespace fjr {

class ExecutorWatch {
 public:
  using Clock = std::chrono::steady_clock;

  ExecutorWatch(std::string robot_id, std::string robot_hash);

  // Of any robot. source: who says it; two may speak for one robot.
  void heard(const ExecutorState& state, std::uint64_t source = 0, Clock::time_point now = Clock::now());
  void lost(const std::string& robot_id);          // nobody speaks for it any more
  void published(const RequestId& trajectory_id);  // to be executed: it will move the arm
  void concluded(const RequestId& trajectory_id);  // executed, or refused

  bool met() const { return met_; }             // whether one was ever heard
  std::optional<ExecutorState> latest() const;  // that was heard a moment ago
  std::uint64_t source() const;                 // who said it last; 0: nobody
  std::optional<std::uint64_t> epoch() const;   // of two who speak for the robot the smaller: nothing moves meanwhile
  bool runs_or_ran(const RequestId& trajectory_id) const;  // last

  // [ns] by the executor's clock, for what is published now; by the service's own while no executor is heard. The wall
  // clocks of the two machines may differ, and be stepped.
  std::int64_t stamp() const;

  // One sentence when two executors speak for the robot: then nobody knows which arm would move.
  std::optional<std::string> twice() const;

  // Link positions [rad] at rest, or one sentence on why there are none.
  std::variant<Joints<double>, std::string> rest() const;

 private:
  struct Speaker {
    std::uint64_t source;
    ExecutorState state;
    Clock::time_point heard;
  };

  bool about_to_move() const;

  const std::string robot_id_, robot_hash_;
  const StampClock own_clock_;
  std::vector<Speaker> speakers_;  // of the robot; heard last at the end
  bool met_ = false;
  std::optional<RequestId> published_;
  Clock::time_point published_at_{};
};

}  // namespace fjr
