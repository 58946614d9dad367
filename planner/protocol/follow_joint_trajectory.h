// ROS 2's action FollowJointTrajectory, apart from how it travels. docs/ros2.md says what becomes of it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "planner/protocol/execution_messages.h"

namespace fjr {

using GoalId = std::array<std::uint8_t, 16>;

// Of lists that others send so much is kept; what is longer is refused for its length.
inline constexpr std::size_t kMostTrajectoryPoints = 4096;
inline constexpr std::size_t kMostListed = 16;

// A list whose size is told also where not all of it is kept.
template <class T>
struct CutList {
  std::vector<T> values;
  std::size_t size = 0;
};

struct FollowPoint {
  CutList<double> positions, velocities, accelerations, effort;  // [rad], [rad/s], [rad/s^2], [N m]
  double time_from_start = 0;                                    // [s]; not a number: it is no duration
};

struct FollowTolerance {
  std::string joint;
  double position = 0, velocity = 0, acceleration = 0;  // 0: none is asked for
};

struct FollowGoal {
  bool stamped = false;  // the header names a time to start at
  CutList<std::string> joint_names;
  CutList<FollowPoint> points;
  CutList<FollowTolerance> path_tolerance, goal_tolerance;
  double goal_time_tolerance = 0;                                                                         // [s]
  bool multi_dof_trajectory = false, component_path_tolerance = false, component_goal_tolerance = false;  // not empty
};

enum class GoalStatus : std::int8_t {  // action_msgs/msg/GoalStatus
  kUnknown = 0,
  kAccepted,
  kExecuting,
  kCanceling,
  kSucceeded,
  kCanceled,
  kAborted,
};

struct FollowResult {
  ResultCode code = ResultCode::kSuccessful;
  std::string sentence;
};

// In the order of the goal's joint names.
struct FollowFeedback {
  std::vector<std::string> joint_names;
  double time = 0;                              // [s] within the motion
  Joints<double> desired{}, actual{}, speed{};  // [rad], [rad/s]
};

struct GoalRecord {
  GoalId id{};
  std::int64_t accepted = 0;  // [ns] since 1970
  GoalStatus status = GoalStatus::kAccepted;
};

enum class CancelCode : std::int8_t { kNone = 0, kRejected, kUnknownGoal, kTerminated };  // action_msgs/srv/CancelGoal

}  // namespace fjr
