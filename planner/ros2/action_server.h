// fjr as a ROS 2 action server of FollowJointTrajectory: an ordinary client of the planning service and the executor.
// Goals are accepted or not, and end, as docs/ros2.md says.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "planner/dds/follow_action_port.h"
#include "planner/protocol/log_limit.h"
#include "planner/ros2/goal_execution.h"
#include "planner/ros2/goal_request.h"

namespace fjr {

struct ActionServerConfig {
  Network network;
  std::string robot_id = "arm";
  std::string action;  // full name; empty: /<robot_id>/follow_joint_trajectory
  GoalReading reading{{"joint1", "joint2"}};
  bool with_indices = false;  // feedback as of control_msgs 6.3
};

class ActionServer {
 public:
  // Throws InputError for a name that ROS 2 does not take.
  explicit ActionServer(const ActionServerConfig& config);

  void run();   // until stop(), and until the arm rests then
  void stop();  // from any thread

 private:
  using Clock = std::chrono::steady_clock;

  struct Goal {
    GoalRecord record;
    FollowResult result;
    std::vector<dds::Ros2Call> waiting;  // for the result
    Clock::time_point ended;
  };

  void turn();
  void take_goal(const dds::FollowActionPort::GoalRequest& request);
  void take_cancel(const dds::FollowActionPort::CancelRequest& request);
  void take_result_request(const dds::FollowActionPort::ResultRequest& request);
  void look_at_execution();
  void begin(Goal& goal, const FollowGoal& asked);
  void end(Goal& goal, GoalOutcome outcome);
  void change(Goal& goal, GoalStatus status);
  void forget_old_goals();
  Goal* find(const GoalId& id);
  Goal* active();
  void publish_status();

  const ActionServerConfig config_;
  const std::string action_;
  dds::FollowActionPort port_;
  LogLimit log_limit_;
  std::vector<std::unique_ptr<Goal>> goals_;  // in the order in which they came
  GoalId active_{};
  std::unique_ptr<GoalExecution> execution_;  // of the active goal; none: none is active
  bool changed_ = true;                       // since the status was published
  std::atomic<bool> stopping_ = false;
};

}  // namespace fjr
