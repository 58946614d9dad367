// Watches the state of the robot's executor: its epoch, and where the arm rests for requests without a start.
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

  // Takes a published state of any robot. source: identifies the publisher, since two executors may claim one robot.
  void heard(const ExecutorState& state, std::uint64_t source = 0, Clock::time_point now = Clock::now());
  void lost(const std::string& robot_id);          // it has no live executor any more
  void published(const RequestId& trajectory_id);  // to be executed: it will move the arm
  void concluded(const RequestId& trajectory_id);  // executed, or refused

  bool met() const { return met_; }                        // whether an executor was ever heard
  std::optional<ExecutorState> latest() const;             // if it is recent
  std::uint64_t source() const;                            // publisher of the latest state; 0: none
  std::optional<std::uint64_t> epoch() const;              // the smaller if two claim the robot: nothing moves then
  bool runs_or_ran(const RequestId& trajectory_id) const;  // whether the executor runs it, or ran it last

  // Returns the time stamp [ns] for publishing now. It follows the executor's clock, because the wall clocks of the two
  // machines may differ and may be stepped; without an executor it is the service's own clock.
  std::int64_t stamp() const;

  // Returns a sentence if two executors claim the robot, because then it is unknown which arm would move.
  std::optional<std::string> twice() const;
  // Returns a sentence if the executor was stopped. It then refuses every motion until somebody has started it again.
  std::optional<std::string> stopped() const;

  // Returns the link positions [rad] at rest, or a sentence why they are unknown.
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
