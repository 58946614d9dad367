#include "planner/dds/client_port.h"

#include <utility>

#include "common/input_error.h"
#include "planner/dds/incompatible.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/wire_reply.h"
#include "planner/dds/wire_request.h"

namespace fjr::dds {

// The readers are created before the writers, so that a service that receives a request can already reply.
ClientPort::ClientPort(Participant participant, const RequestId& client)
    : participant_(std::move(participant)),
      waitset_(participant_),
      discovery_(participant_),
      subscriber_(participant_.subscriber(client_name(client))),
      replies_(participant_, subscriber_.handle()),
      progress_(participant_, subscriber_.handle()),
      results_(participant_, participant_.handle()),
      services_(participant_, participant_.handle()),
      motion_requests_(participant_, participant_.handle()),
      plan_requests_2_(participant_, participant_.handle()),
      plan_requests_(participant_, participant_.handle()),
      motion_cancels_(participant_, participant_.handle()),
      plan_cancels_(participant_, participant_.handle()) {
  waitset_.attach(replies_.arrived());
  waitset_.attach(progress_.arrived());
  waitset_.attach(results_.arrived());
  waitset_.attach(services_.arrived());
}

bool ClientPort::send(const Order& order) {
  return all_know_motion_requests() ? motion_requests_.write(encode(order)) : send_as_before(order);
}

// Returns whether all services know MotionRequest. Otherwise one of an earlier version may have to answer.
bool ClientPort::all_know_motion_requests() const {
  return motion_requests_.has_reader() && motion_requests_.readers() >= plan_requests_.readers();
}

bool ClientPort::send_as_before(const Order& order) {
  const WireRequest wire = encode_plan_request(order);
  if (fits_plan_request(wire.message)) return plan_requests_.write(wire.message.request);
  if (!plan_requests_2_.has_reader()) {
    throw InputError(order.name, "",
                     "asks for what the service, of an older version, does not know; `fjr plan` plans it");
  }
  return plan_requests_2_.write(wire.message);
}

bool ClientPort::cancel(const RequestId& id, const std::string& robot_id) {
  if (!all_know_motion_requests()) return plan_cancels_.write({encode(id)});
  fjr_msg_MotionCancel message{encode(id), {}};
  set_text(message.robot_id, robot_id);
  return motion_cancels_.write(message);
}

std::vector<Reply> ClientPort::take_replies() {
  std::vector<Reply> replies;
  replies_.take_all([&](const fjr_msg_PlanReply& message, const dds_sample_info_t& info) {
    if (info.valid_data) replies.push_back(decode(message));
  });
  return replies;
}

std::vector<ProgressReport> ClientPort::take_progress() {
  std::vector<ProgressReport> reports;
  progress_.take_all([&](const fjr_msg_PlanStatus& message, const dds_sample_info_t& info) {
    if (info.valid_data) reports.push_back(decode(message));
  });
  return reports;
}

std::vector<ExecutionResult> ClientPort::take_results() {
  std::vector<ExecutionResult> results;
  results_.take_all([&](const fjr_msg_ExecutionResult& message, const dds_sample_info_t& info) {
    if (info.valid_data) results.push_back(decode(message));
  });
  return results;
}

std::vector<ServiceStatus> ClientPort::take_services() {
  std::vector<ServiceStatus> services;
  services_.take_all([&](const fjr_msg_PlannerStatus& message, const dds_sample_info_t& info) {
    if (info.valid_data) services.push_back(decode(message));
  });
  return services;
}

// The states do not wake up waits, which would end a thousand times a second. They are read when something else does.
void ClientPort::follow_executors() {
  if (!executors_) executors_.emplace(participant_, participant_.handle());
}

std::vector<ExecutorState> ClientPort::take_executors() {
  std::vector<ExecutorState> states;
  if (!executors_) return states;
  executors_->take_all([&](const fjr_msg_ExecutorState& message, const dds_sample_info_t& info) {
    if (info.valid_data) states.push_back(decode(message));
  });
  return states;
}

std::optional<std::string> ClientPort::why_unserved() const {
  using Topic = TopicOf<fjr_msg_PlanRequest>;
  return incompatibility(participant_, Side::kReaders, Topic::kName, Topic::descriptor()->m_typename,
                         plan_requests_.handle());
}

std::optional<std::string> ClientPort::why_unanswered() const {
  using Topic = TopicOf<fjr_msg_PlanReply>;
  if (replies_.has_writer()) return std::nullopt;
  return incompatibility(participant_, Side::kWriters, Topic::kName, Topic::descriptor()->m_typename,
                         replies_.handle());
}

}  // namespace fjr::dds
