// A ROS 2 action client of FollowJointTrajectory as rmw_cyclonedds_cpp and rcl_action make one, on Cyclone DDS and
// ros2_types.idl alone: nothing of fjr's is included, so that what both believe of ROS 2 is written down twice.
#pragma once

#include <dds/dds.h>
#include <ros2_types.h>

#include <array>
#include <chrono>
#include <cstring>
#include <functional>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace ros2_test {

using Uuid = std::array<std::uint8_t, 16>;

inline Uuid random_uuid() {
  static std::random_device device;
  Uuid id;
  for (std::uint8_t& byte : id) byte = static_cast<std::uint8_t>(device());
  return id;
}

enum Status { kUnknown, kAccepted, kExecuting, kCanceling, kSucceeded, kCanceled, kAborted };

inline dds_return_t checked(dds_return_t returned, const std::string& what) {
  if (returned < 0) throw std::runtime_error(what + ": " + dds_strretcode(-returned));
  return returned;
}

struct Point {
  std::vector<double> positions, velocities = {}, accelerations = {}, effort = {};
  double time = 0;
};
struct Tolerance {
  std::string name;
  double position = 0, velocity = 0, acceleration = 0;
};

// What a test changes of a goal, and how it becomes the C structure.
struct Goal {
  std::vector<std::string> names{"joint1", "joint2"};
  std::vector<Point> points;
  std::vector<Tolerance> path_tolerance, goal_tolerance;
  double goal_time_tolerance = 0;
  int stamp = 0;
  bool multi_dof = false, component_path_tolerance = false, component_goal_tolerance = false;
};

struct Result {
  int status;
  int code;
  std::string text;
};

struct Feedback {
  Uuid id;
  std::vector<std::string> names;
  std::vector<double> desired, actual, velocity, error;
  double time;
};

inline builtin_interfaces_msg_dds__Duration_ duration(double seconds) {
  const auto ns = static_cast<std::int64_t>(std::llround(seconds * 1e9));
  return {static_cast<std::int32_t>(ns / 1000000000), static_cast<std::uint32_t>(ns % 1000000000)};
}

inline dds_sequence_double list(std::vector<double>& values) {
  const auto size = static_cast<std::uint32_t>(values.size());
  return {size, size, values.data(), false};
}

template <class List, class T>
void point_at(List& list, std::vector<T>& values) {
  list._length = list._maximum = static_cast<std::uint32_t>(values.size());
  list._buffer = values.data();
}

inline unique_identifier_msgs_msg_dds__UUID_ wire(const Uuid& id) {
  unique_identifier_msgs_msg_dds__UUID_ message;
  std::memcpy(message.bytes_, id.data(), id.size());
  return message;
}

inline bool same(const unique_identifier_msgs_msg_dds__UUID_& a, const Uuid& b) {
  return std::memcmp(a.bytes_, b.data(), b.size()) == 0;
}

// ---- entities ----

inline dds_entity_t topic(dds_entity_t participant, const dds_topic_descriptor_t& type, const std::string& name) {
  return checked(dds_create_topic(participant, &type, name.c_str(), nullptr, nullptr), name);
}

// rmw_qos_profile_services_default, which is rmw_qos_profile_default too.
inline dds_qos_t* default_qos() {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_INFINITY);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  dds_qset_writer_data_lifecycle(qos, false);
  return qos;
}

inline std::string user_data(const dds_qos_t* qos) {
  void* data = nullptr;
  size_t size = 0;
  if (!dds_qget_userdata(qos, &data, &size) || data == nullptr) return "";
  std::string text(static_cast<char*>(data), size);
  dds_free(data);
  return text;
}

// The client's half of a service: requests out, responses in, and the header in both.
template <class Request, class Response>
class Service {
 public:
  Service(dds_entity_t participant, const dds_topic_descriptor_t& request, const dds_topic_descriptor_t& response,
          const std::string& name, bool deaf = false) {
    dds_qos_t* qos = default_qos();
    const std::string id = "clientid=" + hexadecimal(random_uuid()) + ";";
    dds_qset_userdata(qos, id.data(), id.size());
    writer_ = checked(
        dds_create_writer(participant, topic(participant, request, "rq" + name + "Request"), qos, nullptr), "writer");
    if (!deaf) {
      reader_ = checked(
          dds_create_reader(participant, topic(participant, response, "rr" + name + "Reply"), qos, nullptr), "reader");
    }
    dds_delete_qos(qos);
    checked(dds_get_instance_handle(writer_, &guid_), "instance handle");
  }

  // rmw_service_server_is_available.
  bool available() const {
    std::array<dds_instance_handle_t, 16> handles{};
    std::set<std::string> ids;
    int readers = checked(dds_get_matched_subscriptions(writer_, handles.data(), handles.size()), "subscriptions");
    for (int i = 0; i < readers; ++i) {
      auto* endpoint = dds_get_matched_subscription_data(writer_, handles[static_cast<std::size_t>(i)]);
      if (endpoint == nullptr) continue;
      ids.insert(user_data(endpoint->qos));
      dds_builtintopic_free_endpoint(endpoint);
    }
    const int writers = checked(dds_get_matched_publications(reader_, handles.data(), handles.size()), "publications");
    for (int i = 0; i < writers; ++i) {
      auto* endpoint = dds_get_matched_publication_data(reader_, handles[static_cast<std::size_t>(i)]);
      if (endpoint == nullptr) continue;
      const std::string id = user_data(endpoint->qos);
      dds_builtintopic_free_endpoint(endpoint);
      if (id.starts_with("serviceid=") && ids.contains(id)) return true;
    }
    return false;
  }

  // Returns the number that the response will bear.
  std::int64_t send(Request& request) {
    request.guid_ = guid_;
    request.seq_ = ++count_;
    checked(dds_write(writer_, &request), "write");
    return count_;
  }

  // use(response) for the one to this number. `strangers` counts what was for others.
  template <class Use>
  bool await(std::int64_t number, double seconds, Use use) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      void* sample = nullptr;
      dds_sample_info_t info;
      bool found = false;
      while (checked(dds_take(reader_, &sample, &info, 1, 1), "take") > 0) {
        const auto* response = static_cast<const Response*>(sample);
        if (info.valid_data && response->guid_ != guid_) ++strangers;
        if (info.valid_data && response->guid_ == guid_ && response->seq_ == number) {
          use(*response);
          found = true;
        }
        dds_return_loan(reader_, &sample, 1);
        sample = nullptr;
        if (found) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }

  dds_entity_t writer() const { return writer_; }

  int strangers = 0;

 private:
  static std::string hexadecimal(const Uuid& id) {
    std::string text;
    for (const std::uint8_t byte : id) {
      text += "0123456789abcdef"[byte >> 4];
      text += "0123456789abcdef"[byte & 15];
    }
    return text;
  }

  dds_entity_t writer_ = 0, reader_ = 0;
  dds_instance_handle_t guid_ = 0;
  std::int64_t count_ = 0;
};

class Client {
 public:
  explicit Client(unsigned domain, const std::string& action = "/arm/follow_joint_trajectory")
      : participant_(checked(dds_create_participant(domain, nullptr, nullptr), "participant")),
        send_goal(participant_, control_msgs_action_dds__FollowJointTrajectory_SendGoal_Request__desc,
                  control_msgs_action_dds__FollowJointTrajectory_SendGoal_Response__desc,
                  action + "/_action/send_goal"),
        cancel_goal(participant_, action_msgs_srv_dds__CancelGoal_Request__desc,
                    action_msgs_srv_dds__CancelGoal_Response__desc, action + "/_action/cancel_goal"),
        get_result(participant_, control_msgs_action_dds__FollowJointTrajectory_GetResult_Request__desc,
                   control_msgs_action_dds__FollowJointTrajectory_GetResult_Response__desc,
                   action + "/_action/get_result") {
    dds_qos_t* qos = default_qos();
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);  // not one is missed where it is counted
    feedback_ = checked(
        dds_create_reader(participant_,
                          topic(participant_, control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage__desc,
                                "rt" + action + "/_action/feedback"),
                          qos, nullptr),
        "feedback");
    dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);  // rcl_action_qos_profile_status_default
    status_ = checked(dds_create_reader(participant_,
                                        topic(participant_, action_msgs_msg_dds__GoalStatusArray__desc,
                                              "rt" + action + "/_action/status"),
                                        qos, nullptr),
                      "status");
    dds_delete_qos(qos);
  }
  ~Client() { dds_delete(participant_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  // rcl_action_server_is_available.
  bool server_is_available() const {
    dds_subscription_matched_status_t feedback, status;
    checked(dds_get_subscription_matched_status(feedback_, &feedback), "matched");
    checked(dds_get_subscription_matched_status(status_, &status), "matched");
    return send_goal.available() && cancel_goal.available() && get_result.available() && feedback.current_count > 0 &&
           status.current_count > 0;
  }

  std::int64_t post(const Uuid& id, Goal goal) {
    control_msgs_action_dds__FollowJointTrajectory_SendGoal_Request_ request{};
    request.goal_id_ = wire(id);
    std::string none;
    auto& trajectory = request.goal_.trajectory_;
    trajectory.header_.frame_id_ = request.goal_.multi_dof_trajectory_.header_.frame_id_ = none.data();
    trajectory.header_.stamp_.sec_ = goal.stamp;
    std::vector<char*> names;
    for (std::string& name : goal.names) names.push_back(name.data());
    point_at(trajectory.joint_names_, names);
    std::vector<trajectory_msgs_msg_dds__JointTrajectoryPoint_> points;
    for (Point& point : goal.points) {
      points.push_back({list(point.positions), list(point.velocities), list(point.accelerations), list(point.effort),
                        duration(point.time)});
    }
    point_at(trajectory.points_, points);
    std::vector<char*> some{none.data()};
    if (goal.multi_dof) point_at(request.goal_.multi_dof_trajectory_.joint_names_, some);
    std::vector<control_msgs_msg_dds__JointTolerance_> path, end;
    for (Tolerance& t : goal.path_tolerance) path.push_back({t.name.data(), t.position, t.velocity, t.acceleration});
    for (Tolerance& t : goal.goal_tolerance) end.push_back({t.name.data(), t.position, t.velocity, t.acceleration});
    point_at(request.goal_.path_tolerance_, path);
    point_at(request.goal_.goal_tolerance_, end);
    std::vector<control_msgs_msg_dds__JointComponentTolerance_> component{{none.data(), 4, 0.1, 0, 0}};
    if (goal.component_path_tolerance) point_at(request.goal_.component_path_tolerance_, component);
    if (goal.component_goal_tolerance) point_at(request.goal_.component_goal_tolerance_, component);
    request.goal_.goal_time_tolerance_ = duration(goal.goal_time_tolerance);
    return send_goal.send(request);
  }

  // Nothing: no answer came.
  std::optional<bool> accepted(std::int64_t number, double within = 5) {
    bool yes = false;
    const bool came = send_goal.await(number, within, [&](const auto& response) { yes = response.accepted_; });
    return came ? std::optional(yes) : std::nullopt;
  }
  std::optional<bool> send(const Uuid& id, const Goal& goal) { return accepted(post(id, goal)); }

  std::int64_t ask_result(const Uuid& id) {
    control_msgs_action_dds__FollowJointTrajectory_GetResult_Request_ request{};
    request.goal_id_ = wire(id);
    return get_result.send(request);
  }
  std::optional<Result> await_result(std::int64_t number, double within = 30) {
    Result result{};
    const bool came = get_result.await(number, within, [&](const auto& response) {
      result = {response.status_, response.result_.error_code_, response.result_.error_string_};
    });
    return came ? std::optional(result) : std::nullopt;
  }
  std::optional<Result> result(const Uuid& id, double within = 30) { return await_result(ask_result(id), within); }

  struct Cancelled {
    int code;
    std::vector<Uuid> goals;
  };
  std::optional<Cancelled> cancel(const Uuid& id, int stamp = 0) {
    action_msgs_srv_dds__CancelGoal_Request_ request{};
    request.goal_info_.goal_id_ = wire(id);
    request.goal_info_.stamp_.sec_ = stamp;
    Cancelled cancelled{};
    const bool came = cancel_goal.await(cancel_goal.send(request), 5, [&](const auto& response) {
      cancelled.code = response.return_code_;
      for (std::uint32_t i = 0; i < response.goals_canceling_._length; ++i) {
        Uuid& one = cancelled.goals.emplace_back();
        std::memcpy(one.data(), response.goals_canceling_._buffer[i].goal_id_.bytes_, one.size());
      }
    });
    return came ? std::optional(cancelled) : std::nullopt;
  }

  // What has come since the last call.
  std::vector<Feedback> take_feedback() {
    std::vector<Feedback> all;
    take<control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage_>(feedback_, [&](const auto& message) {
      const auto& wire = message.feedback_;
      Feedback& one = all.emplace_back();
      std::memcpy(one.id.data(), message.goal_id_.bytes_, one.id.size());
      for (std::uint32_t i = 0; i < wire.joint_names_._length; ++i) one.names.push_back(wire.joint_names_._buffer[i]);
      const auto numbers = [](const dds_sequence_double& from) {
        return std::vector<double>(from._buffer, from._buffer + from._length);
      };
      one.desired = numbers(wire.desired_.positions_);
      one.actual = numbers(wire.actual_.positions_);
      one.velocity = numbers(wire.actual_.velocities_);
      one.error = numbers(wire.error_.positions_);
      one.time = wire.actual_.time_from_start_.sec_ + wire.actual_.time_from_start_.nanosec_ * 1e-9;
    });
    return all;
  }

  // The statuses of one goal in all arrays that have come since the last call, without repetitions.
  std::vector<int> take_statuses(const Uuid& id) {
    std::vector<int> all;
    take<action_msgs_msg_dds__GoalStatusArray_>(status_, [&](const auto& message) {
      for (std::uint32_t i = 0; i < message.status_list_._length; ++i) {
        const auto& one = message.status_list_._buffer[i];
        if (same(one.goal_info_.goal_id_, id) && (all.empty() || all.back() != one.status_)) all.push_back(one.status_);
      }
    });
    return all;
  }

 private:
  template <class Message, class Use>
  static void take(dds_entity_t reader, Use use) {
    void* sample = nullptr;
    dds_sample_info_t info;
    while (checked(dds_take(reader, &sample, &info, 1, 1), "take") > 0) {
      if (info.valid_data) use(*static_cast<const Message*>(sample));
      dds_return_loan(reader, &sample, 1);
      sample = nullptr;
    }
  }

  dds_entity_t participant_;

 public:
  Service<control_msgs_action_dds__FollowJointTrajectory_SendGoal_Request_,
          control_msgs_action_dds__FollowJointTrajectory_SendGoal_Response_>
      send_goal;
  Service<action_msgs_srv_dds__CancelGoal_Request_, action_msgs_srv_dds__CancelGoal_Response_> cancel_goal;
  Service<control_msgs_action_dds__FollowJointTrajectory_GetResult_Request_,
          control_msgs_action_dds__FollowJointTrajectory_GetResult_Response_>
      get_result;

 private:
  dds_entity_t feedback_ = 0, status_ = 0;
};

// Feedback as of control_msgs 6.3.
class LaterFeedback {
 public:
  explicit LaterFeedback(unsigned domain)
      : participant_(checked(dds_create_participant(domain, nullptr, nullptr), "participant")),
        type_(control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage63__desc) {
    type_.m_typename = control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage__desc.m_typename;
    dds_qos_t* qos = default_qos();
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    const dds_entity_t on = topic(participant_, type_, "rt/arm/follow_joint_trajectory/_action/feedback");
    reader_ = checked(dds_create_reader(participant_, on, qos, nullptr), "reader");
    dds_delete_qos(qos);
  }
  ~LaterFeedback() { dds_delete(participant_); }
  LaterFeedback(const LaterFeedback&) = delete;
  LaterFeedback& operator=(const LaterFeedback&) = delete;

  // How many have come that make sense to the last member.
  int take() {
    int count = 0;
    void* sample = nullptr;
    dds_sample_info_t info;
    while (checked(dds_take(reader_, &sample, &info, 1, 1), "take") > 0) {
      const auto& message = *static_cast<control_msgs_action_dds__FollowJointTrajectory_FeedbackMessage63_*>(sample);
      const auto& feedback = message.feedback_;
      count += info.valid_data && feedback.index_ == 0 && feedback.multi_dof_index_ == 0 &&
                       feedback.actual_.positions_._length == 2
                   ? 1
                   : 0;
      dds_return_loan(reader_, &sample, 1);
      sample = nullptr;
    }
    return count;
  }

 private:
  dds_entity_t participant_, reader_ = 0;
  dds_topic_descriptor_t type_;
};

}  // namespace ros2_test
