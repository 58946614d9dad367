// The server's side of ROS 2's action FollowJointTrajectory: three services and two topics.
#pragma once

#include <follow_joint_trajectory.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/dds/ros2_service.h"
#include "planner/dds/waitset.h"
#include "planner/dds/writer.h"
#include "planner/protocol/follow_joint_trajectory.h"

namespace fjr::dds {

using SendGoalRequest = control_msgs_action_dds__FollowJointTrajectory_SendGoal_Request_;
using SendGoalResponse = control_msgs_action_dds__FollowJointTrajectory_SendGoal_Response_;
using GetResultRequest = control_msgs_action_dds__FollowJointTrajectory_GetResult_Request_;
using GetResultResponse = control_msgs_action_dds__FollowJointTrajectory_GetResult_Response_;
using CancelGoalRequest = action_msgs_srv_dds__CancelGoal_Request_;
using CancelGoalResponse = action_msgs_srv_dds__CancelGoal_Response_;
using FeedbackMessage = control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage_;
using FeedbackMessage63 = control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage_6_3_;
using GoalStatusArray = action_msgs_msg_dds__GoalStatusArray_;

// The types of a service's two directions. The topics' names depend on the action's.
template <const dds_topic_descriptor_t& kDescriptor>
struct Ros2ServiceTopic {
  static constexpr const char* kName = "a ROS 2 service";  // in errors
  static const dds_topic_descriptor_t* descriptor() { return &kDescriptor; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(5)).keep_last(64)); }
};

template <>
struct TopicOf<SendGoalRequest>
    : Ros2ServiceTopic<control_msgs_action_dds__FollowJointTrajectory_SendGoal_Request__desc> {};
template <>
struct TopicOf<SendGoalResponse>
    : Ros2ServiceTopic<control_msgs_action_dds__FollowJointTrajectory_SendGoal_Response__desc> {};
template <>
struct TopicOf<GetResultRequest>
    : Ros2ServiceTopic<control_msgs_action_dds__FollowJointTrajectory_GetResult_Request__desc> {};
template <>
struct TopicOf<GetResultResponse>
    : Ros2ServiceTopic<control_msgs_action_dds__FollowJointTrajectory_GetResult_Response__desc> {};
template <>
struct TopicOf<CancelGoalRequest> : Ros2ServiceTopic<action_msgs_srv_dds__CancelGoal_Request__desc> {};
template <>
struct TopicOf<CancelGoalResponse> : Ros2ServiceTopic<action_msgs_srv_dds__CancelGoal_Response__desc> {};

// rmw_qos_profile_default.
template <>
struct TopicOf<FeedbackMessage> {
  static constexpr const char* kName = "feedback";
  static const dds_topic_descriptor_t* descriptor() {
    return &control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage__desc;
  }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(0)).keep_last(10)); }
};

template <>
struct TopicOf<FeedbackMessage63> {
  static constexpr const char* kName = "feedback";
  static const dds_topic_descriptor_t* descriptor();  // has the name of the type above
  static Qos qos() { return TopicOf<FeedbackMessage>::qos(); }
};

// rcl_action_qos_profile_status_default.
template <>
struct TopicOf<GoalStatusArray> {
  static constexpr const char* kName = "status";
  static const dds_topic_descriptor_t* descriptor() { return &action_msgs_msg_dds__GoalStatusArray__desc; }
  static Qos qos() {
    return std::move(Qos().reliable(DDS_MSECS(5)).transient_local().keep_last(1).late_joiners_get(1));
  }
};

class FollowActionPort {
 public:
  struct GoalRequest {
    Ros2Call call;
    GoalId id;
    FollowGoal goal;
  };
  struct CancelRequest {
    Ros2Call call;
    GoalId id;              // all zero: none
    std::int64_t stamp_ns;  // 0: none
  };
  struct ResultRequest {
    Ros2Call call;
    GoalId id;
  };

  // action: its full name, as in /arm/follow_joint_trajectory. with_indices: feedback as of control_msgs 6.3.
  FollowActionPort(Participant participant, const std::string& action, bool with_indices);

  void wait(std::chrono::nanoseconds timeout);  // waits less while a response waits for its reader
  void wake() const { waitset_.wake(); }        // from any thread

  // Returns a bounded number of goals; the rest stays for the next call.
  std::vector<GoalRequest> take_goals();
  std::vector<CancelRequest> take_cancels();
  std::vector<ResultRequest> take_result_requests();

  void answer_goal(const Ros2Call& call, bool accepted, std::int64_t accepted_ns);
  void answer_cancel(const Ros2Call& call, CancelCode code, const std::vector<GoalRecord>& canceling);
  void answer_result(const Ros2Call& call, GoalStatus status, const FollowResult& result);
  void publish_status(const std::vector<GoalRecord>& goals);
  void publish_feedback(const GoalId& id, const FollowFeedback& feedback, std::int64_t now_ns);

 private:
  Participant participant_;
  Waitset waitset_;
  Ros2Service<SendGoalRequest, SendGoalResponse> send_goal_;
  Ros2Service<CancelGoalRequest, CancelGoalResponse> cancel_goal_;
  Ros2Service<GetResultRequest, GetResultResponse> get_result_;
  std::optional<Writer<FeedbackMessage>> feedback_;
  std::optional<Writer<FeedbackMessage63>> feedback_6_3_;
  Writer<GoalStatusArray> status_;
};

}  // namespace fjr::dds
