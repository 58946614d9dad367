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

  bool served() const { return plan_requests_.has_reader(); }  // somebody takes requests; no proof of delivery
  // By fjr/motion_request where all services here take it. InputError: not the shape of a request, or nobody here takes
  // what it asks for.
  bool send(const Order& order);
  bool cancel(const RequestId& id, const std::string& robot_id = "");  // of the request

  std::vector<Reply> take_replies();
  std::vector<ProgressReport> take_progress();
  std::vector<ExecutionResult> take_results();
  std::vector<ServiceStatus> take_services();  // the latest word of each

  // The executors' states come a thousand times a second, to whoever wants them.
  void follow_executors();
  bool any_executor() const { return executors_ && executors_->has_writer(); }
  std::vector<ExecutorState> take_executors();

  Discovery& discovery() { return discovery_; }

  // Why requests, or replies to them, do not come through although somebody is there; nothing: nobody is.
  std::optional<std::string> why_unserved() const;
  std::optional<std::string> why_unanswered() const;

 private:
  bool all_know_motion_requests() const;
  bool send_as_before(const Order& order);  // by what earlier versions take

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
