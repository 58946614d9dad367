// ROS 2's action FollowJointTrajectory, independent of the transport. docs/ros2.md describes how it is carried out.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "planner/protocol/execution_messages.h"

namespace fjr {

using GoalId = std::array<std::uint8_t, 16>;

// Numbers of elements that are kept of received lists. Longer lists are refused.
inline constexpr std::size_t kMostTrajectoryPoints = 4096;
inline constexpr std::size_t kMostListed = 16;

// A list that keeps its original size if it was cut.
template <class T>
struct CutList {
  std::vector<T> values;
  std::size_t size = 0;
};

struct FollowPoint {
  CutList<double> positions, velocities, accelerations, effort;  // [rad], [rad/s], [rad/s^2], [N m]
  double time_from_start = 0;                                    // [s]; NaN if it is no valid duration
};

struct FollowTolerance {
  std::string joint;
  double position = 0, velocity = 0, acceleration = 0;  // 0: no tolerance is requested
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

// Feedback; joints are in the order of the goal's joint names.
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
