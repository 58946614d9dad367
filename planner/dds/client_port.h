// The client's side of the protocol.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "planner/dds/discovery.h"
#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/dds/waitset.h"
#include "planner/dds/writer.h"
#include "planner/protocol/execution_messages.h"
#include "planner/protocol/messages.h"

namespace fjr::dds {

class ClientPort {
 public:
  ClientPort(Participant participant, const RequestId& client);

  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }

  bool served() const { return plan_requests_.has_reader(); }  // a service reads requests; no proof of delivery
  // Sends a request, by fjr/motion_request if all services here read that. Throws InputError if the document is not a
  // request, or if no service here supports it.
  bool send(const Order& order);
  bool cancel(const RequestId& id, const std::string& robot_id = "");  // of the request

  std::vector<Reply> take_replies();
  std::vector<ProgressReport> take_progress();
  std::vector<ExecutionResult> take_results();
  std::vector<ServiceStatus> take_services();  // the latest word of each

  // Subscribes to the states of executors, which are published a thousand times a second.
  void follow_executors();
  bool any_executor() const { return executors_ && executors_->has_writer(); }
  std::vector<ExecutorState> take_executors();

  Discovery& discovery() { return discovery_; }

  // Returns why requests or replies do not get through although a participant is there, or nothing if there is none.
  std::optional<std::string> why_unserved() const;
  std::optional<std::string> why_unanswered() const;

 private:
  bool all_know_motion_requests() const;
  bool send_as_before(const Order& order);  // by the topics of earlier versions

  Participant participant_;
  Waitset waitset_;
  Discovery discovery_;
  Entity subscriber_;
  Reader<fjr_msg_PlanReply> replies_;
  Reader<fjr_msg_PlanStatus> progress_;
  Reader<fjr_msg_ExecutionResult> results_;
  Reader<fjr_msg_PlannerStatus> services_;
  Writer<fjr_msg_MotionRequest> motion_requests_;
  Writer<fjr_msg_PlanRequest2> plan_requests_2_;
  Writer<fjr_msg_PlanRequest> plan_requests_;
  Writer<fjr_msg_MotionCancel> motion_cancels_;
  Writer<fjr_msg_PlanCancel> plan_cancels_;
  std::optional<Reader<fjr_msg_ExecutorState>> executors_;
};

}  // namespace fjr::dds
