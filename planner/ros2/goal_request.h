// A goal of FollowJointTrajectory as a request to the planning service.
#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/protocol/follow_joint_trajectory.h"

namespace fjr {

using JointNames = std::array<std::string, kJoints>;  // of fjr's joints 1 and 2

inline constexpr std::size_t kMostIntermediatePoints = 32;  // between start and goal: so many via points has a request

class GoalRefused : public std::runtime_error {
 public:
  GoalRefused(ResultCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
  ResultCode code() const { return code_; }

 private:
  ResultCode code_;
};

struct GoalRequest {
  std::string document;                               // what is to be planned, as a request file says it
  std::vector<std::string> joint_names;               // in the goal's order
  std::array<std::size_t, kJoints> place{};           // of fjr's joints in that order
  Joints<double> path_tolerance{}, goal_tolerance{};  // [rad] 0: the executor's own
  bool on_time = false;                               // within `goal_tolerance` by a time after the end
};

struct GoalReading {
  JointNames names;
  bool leave_accelerations = false;  // those of intermediate points are not looked at, instead of refused
};

// Throws GoalRefused, with the field that is wrong, and what is allowed.
GoalRequest request_of(const FollowGoal& goal, const GoalReading& reading);

// What the goal's own tolerances make of an execution that the executor calls successful.
FollowResult judged(const GoalRequest& request, const ExecutionResult& executed);

// The link that is further off its plan than the goal allows; nothing: none is.
std::optional<FollowResult> strayed(const GoalRequest& request, const ExecutorState& state);

FollowFeedback feedback_of(const GoalRequest& request, double time, const ExecutorState& state);

}  // namespace fjr
