#include "planner/dds/follow_action_port.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include "planner/protocol/printable.h"

namespace fjr::dds {
namespace {

using WirePoint = trajectory_msgs_msg_dds__JointTrajectoryPoint_;
using WireDuration = builtin_interfaces_msg_dds__Duration_;
using WireTime = builtin_interfaces_msg_dds__Time_;
using WireUuid = unique_identifier_msgs_msg_dds__UUID_;

constexpr std::int64_t kSecondInNs = 1'000'000'000;
constexpr std::size_t kMostInOneTurn = 16;
constexpr std::size_t kLongestText = 64;

// ---- what is received ----

template <class List, class Convert>
auto cut_list(const List& list, std::size_t most, Convert convert) {
  CutList<decltype(convert(list._buffer[0]))> cut;
  cut.size = list._length;
  for (std::size_t i = 0; i < std::min<std::size_t>(list._length, most); ++i) {
    cut.values.push_back(convert(list._buffer[i]));
  }
  return cut;
}

std::string text_from(const char* text) {
  if (text == nullptr) return "";
  return printable(std::string_view(text, ::strnlen(text, kLongestText)));
}

CutList<double> numbers_from(const dds_sequence_double& list) {
  return cut_list(list, kMostListed, [](double value) { return value; });
}

double seconds_from(const WireDuration& duration) {
  if (duration.nanosec >= kSecondInNs) return std::numeric_limits<double>::quiet_NaN();
  return duration.sec + duration.nanosec * 1e-9;
}

FollowPoint point_from(const WirePoint& point) {
  return {numbers_from(point.positions_), numbers_from(point.velocities_), numbers_from(point.accelerations_),
          numbers_from(point.effort_), seconds_from(point.time_from_start_)};
}

template <class List>
CutList<FollowTolerance> tolerances_from(const List& list) {
  return cut_list(list, kMostListed, [](const auto& one) {
    return FollowTolerance{text_from(one.name_), one.position_, one.velocity_, one.acceleration_};
  });
}

FollowGoal goal_from(const control_msgs_action_dds__FollowJointTrajectory_Goal_& wire) {
  FollowGoal goal;
  const auto& trajectory = wire.trajectory_;
  goal.stamped = trajectory.header_.stamp_.sec != 0 || trajectory.header_.stamp_.nanosec != 0;
  goal.joint_names = cut_list(trajectory.joint_names_, kMostListed, text_from);
  goal.points = cut_list(trajectory.points_, kMostTrajectoryPoints, point_from);
  goal.path_tolerance = tolerances_from(wire.path_tolerance_);
  goal.goal_tolerance = tolerances_from(wire.goal_tolerance_);
  goal.goal_time_tolerance = seconds_from(wire.goal_time_tolerance_);
  const auto& others = wire.multi_dof_trajectory_;
  goal.multi_dof_trajectory = others.joint_names_._length > 0 || others.points_._length > 0;
  goal.component_path_tolerance = wire.component_path_tolerance_._length > 0;
  goal.component_goal_tolerance = wire.component_goal_tolerance_._length > 0;
  return goal;
}

GoalId goal_id_from(const WireUuid& wire) { return std::to_array(wire.value_); }

// ---- what is written ----

WireTime wire_time(std::int64_t ns) {
  return {static_cast<std::int32_t>(ns / kSecondInNs), static_cast<std::uint32_t>(ns % kSecondInNs)};
}

WireUuid wire_uuid(const GoalId& id) {
  WireUuid wire;
  std::copy(id.begin(), id.end(), wire.value_);
  return wire;
}

action_msgs_msg_dds__GoalInfo_ wire_info(const GoalRecord& goal) {
  return {wire_uuid(goal.id), wire_time(goal.accepted)};
}

// Points into `items`; only read when written.
template <class List, class Item>
void list_of_items(List& list, std::vector<Item>& items) {
  list._length = list._maximum = static_cast<std::uint32_t>(items.size());
  list._buffer = items.data();
}

dds_sequence_double pair_list(Joints<double>& values) { return {kJoints, kJoints, values.data(), false}; }

template <class Message>
Message response_to(const Ros2Call& call) {
  Message message{};
  message.client_ = call.client;
  message.number_ = call.number;
  return message;
}

// The texts and numbers that a feedback message points to.
struct FeedbackValues {
  FollowFeedback feedback;
  Joints<double> error;
  std::vector<char*> names;
  std::string frame;
};

template <class Message>
bool write_feedback(Writer<Message>& writer, const GoalId& id, FeedbackValues& values, std::int64_t now_ns) {
  Message message{};
  message.goal_id_ = wire_uuid(id);
  auto& wire = message.feedback_;
  wire.header_.stamp_ = wire_time(now_ns);
  wire.header_.frame_id_ = values.frame.data();
  list_of_items(wire.joint_names_, values.names);
  wire.desired_.positions_ = pair_list(values.feedback.desired);
  wire.actual_.positions_ = pair_list(values.feedback.actual);
  wire.actual_.velocities_ = pair_list(values.feedback.speed);
  wire.error_.positions_ = pair_list(values.error);
  const auto time = static_cast<std::int64_t>(values.feedback.time * 1e9);
  for (auto* point : {&wire.desired_, &wire.actual_, &wire.error_}) {
    point->time_from_start_ = {static_cast<std::int32_t>(time / kSecondInNs),
                               static_cast<std::uint32_t>(time % kSecondInNs)};
  }
  return writer.write(message);
}

std::string service_id(const Participant& participant, int service) {
  dds_guid_t guid{};
  checked(dds_get_guid(participant.handle(), &guid), "GUID");
  std::string id;
  for (const std::uint8_t byte : guid.v) id += fmt::format("{:02x}", byte);
  return fmt::format("{}.{}", id, service);
}

}  // namespace

const dds_topic_descriptor_t* TopicOf<FeedbackMessage63>::descriptor() {
  static const dds_topic_descriptor_t renamed = [] {
    dds_topic_descriptor_t copy = control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage_6_3__desc;
    copy.m_typename = control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage__desc.m_typename;
    return copy;
  }();
  return &renamed;
}

FollowActionPort::FollowActionPort(Participant participant, const std::string& action, bool with_indices)
    : participant_(std::move(participant)),
      waitset_(participant_),
      send_goal_(participant_, action + "/_action/send_goal", service_id(participant_, 1)),
      cancel_goal_(participant_, action + "/_action/cancel_goal", service_id(participant_, 2)),
      get_result_(participant_, action + "/_action/get_result", service_id(participant_, 3)),
      status_(participant_, participant_.handle(), TopicOf<GoalStatusArray>::qos(),
              ("rt" + action + "/_action/status").c_str()) {
  const std::string topic = "rt" + action + "/_action/feedback";
  const Qos qos = TopicOf<FeedbackMessage>::qos();
  if (with_indices) {
    feedback_6_3_.emplace(participant_, participant_.handle(), qos, topic.c_str());
  } else {
    feedback_.emplace(participant_, participant_.handle(), qos, topic.c_str());
  }
  waitset_.attach(send_goal_.arrived());
  waitset_.attach(cancel_goal_.arrived());
  waitset_.attach(get_result_.arrived());
}

void FollowActionPort::wait(std::chrono::nanoseconds timeout) {
  constexpr std::chrono::milliseconds kLookAgain{5};
  const bool waiting = send_goal_.look() | cancel_goal_.look() | get_result_.look();
  waitset_.wait(waiting ? std::min<std::chrono::nanoseconds>(timeout, kLookAgain) : timeout);
}

std::vector<FollowActionPort::GoalRequest> FollowActionPort::take_goals() {
  std::vector<GoalRequest> requests;
  send_goal_.take_at_most(kMostInOneTurn, [&](const SendGoalRequest& wire, const Ros2Call& call) {
    requests.push_back({call, goal_id_from(wire.goal_id_), goal_from(wire.goal_)});
  });
  return requests;
}

std::vector<FollowActionPort::CancelRequest> FollowActionPort::take_cancels() {
  std::vector<CancelRequest> requests;
  cancel_goal_.take_at_most(kMostInOneTurn, [&](const CancelGoalRequest& wire, const Ros2Call& call) {
    const WireTime& stamp = wire.goal_info_.stamp_;
    requests.push_back({call, goal_id_from(wire.goal_info_.goal_id_), stamp.sec * kSecondInNs + stamp.nanosec});
  });
  return requests;
}

std::vector<FollowActionPort::ResultRequest> FollowActionPort::take_result_requests() {
  std::vector<ResultRequest> requests;
  get_result_.take_at_most(kMostInOneTurn, [&](const GetResultRequest& wire, const Ros2Call& call) {
    requests.push_back({call, goal_id_from(wire.goal_id_)});
  });
  return requests;
}

void FollowActionPort::answer_goal(const Ros2Call& call, bool accepted, std::int64_t accepted_ns) {
  auto message = response_to<SendGoalResponse>(call);
  message.accepted_ = accepted;
  message.stamp_ = wire_time(accepted_ns);
  send_goal_.respond(call, [message](Writer<SendGoalResponse>& writer) { return writer.write(message); });
}

void FollowActionPort::answer_cancel(const Ros2Call& call, CancelCode code, const std::vector<GoalRecord>& canceling) {
  std::vector<action_msgs_msg_dds__GoalInfo_> infos;
  for (const GoalRecord& goal : canceling) infos.push_back(wire_info(goal));
  cancel_goal_.respond(call, [call, code, infos](Writer<CancelGoalResponse>& writer) mutable {
    auto message = response_to<CancelGoalResponse>(call);
    message.return_code_ = static_cast<std::int8_t>(code);
    list_of_items(message.goals_canceling_, infos);
    return writer.write(message);
  });
}

void FollowActionPort::answer_result(const Ros2Call& call, GoalStatus status, const FollowResult& result) {
  get_result_.respond(call, [call, status, result = FollowResult(result)](Writer<GetResultResponse>& writer) mutable {
    auto message = response_to<GetResultResponse>(call);
    message.status_ = static_cast<std::int8_t>(status);
    message.result_.error_code_ = static_cast<std::int32_t>(result.code);
    message.result_.error_string_ = result.sentence.data();
    return writer.write(message);
  });
}

void FollowActionPort::publish_status(const std::vector<GoalRecord>& goals) {
  std::vector<action_msgs_msg_dds__GoalStatus_> statuses;
  for (const GoalRecord& goal : goals) {
    statuses.push_back({wire_info(goal), static_cast<std::int8_t>(goal.status)});
  }
  GoalStatusArray message{};
  list_of_items(message.status_list_, statuses);
  (void)status_.write(message);  // if it is lost, the next one repeats it
}

void FollowActionPort::publish_feedback(const GoalId& id, const FollowFeedback& feedback, std::int64_t now_ns) {
  FeedbackValues values{feedback, {}, {}, {}};
  for (std::size_t j = 0; j < kJoints; ++j) values.error[j] = feedback.desired[j] - feedback.actual[j];
  for (std::string& name : values.feedback.joint_names) values.names.push_back(name.data());
  (void)(feedback_ ? write_feedback(*feedback_, id, values, now_ns)
                   : write_feedback(*feedback_6_3_, id, values, now_ns));
}

}  // namespace fjr::dds
