#include "planner/dds/service_port.h"

#include <algorithm>
#include <limits>

#include "planner/dds/permitted.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/wire_reply.h"

namespace fjr::dds {
namespace {

constexpr std::size_t kAtOnce = 128;  // requests taken before the service looks at anything else

// A standby reads replies without acknowledging them, so that it cannot delay the owner's replies.
Qos overheard() { return std::move(Qos().best_effort().keep_last(64).ignore_own()); }

// Relayed requests are acknowledged, so they must not be overwritten before they are read (keep_all).
Qos relayed_by_others() { return std::move(TopicOf<fjr_msg_RelayedRequest>::qos().keep_all().ignore_own()); }

Qos of_others() { return std::move(TopicOf<fjr_msg_PlannerStatus>::qos().ignore_own()); }

Qos of_owner(std::uint64_t epoch) {
  const auto strength = std::min<std::uint64_t>(epoch, std::numeric_limits<int>::max());
  return std::move(TopicOf<fjr_msg_Trajectory>::qos().ownership_strength(static_cast<int>(strength)));
}

bool alive(const dds_sample_info_t& info) { return info.instance_state == DDS_IST_ALIVE; }

}  // namespace

ServicePort::ServicePort(Participant participant)
    : participant_(std::move(participant)),
      waitset_(participant_),
      everywhere_(participant_.subscriber("*")),
      relayed_by_others_(participant_, participant_.handle(), relayed_by_others()),
      relayed_(participant_, participant_.handle()),
      peers_(participant_, participant_.handle(), of_others()),
      replies_of_others_(participant_, everywhere_.handle(), overheard()),
      executors_(participant_, participant_.handle()),
      results_(participant_, participant_.handle()),
      drifts_(if_permitted<Reader<fjr_msg_ArmDrift>>(participant_, TopicOf<fjr_msg_ArmDrift>::kName)),
      runs_(if_permitted<Reader<fjr_msg_ExecutedRun>>(participant_, TopicOf<fjr_msg_ExecutedRun>::kName)),
      status_(participant_, participant_.handle()),
      clients_(participant_) {
  waitset_.attach(peers_.arrived());
  waitset_.attach(relayed_by_others_.arrived());
  waitset_.attach(clients_.changed());
}

// Clients wait for the last of these readers. Once they have discovered it, they can send every kind of request and
// cancellation.
void ServicePort::open() {
  const auto listen = [&](auto& reader) {
    reader.emplace(participant_, participant_.handle());
    waitset_.attach(reader->arrived());
  };
  listen(motion_cancels_);
  listen(plan_cancels_);
  listen(motion_requests_);
  listen(plan_requests_2_);
  listen(plan_requests_);
}

std::vector<Order> ServicePort::take_requests() {
  std::vector<Order> orders;
  if (!is_open()) return orders;
  const auto take_from = [&](auto& reader) {
    reader->take_at_most(kAtOnce, [&](const auto& message, const dds_sample_info_t& info) {
      if (!info.valid_data) return;
      orders.push_back(decode(message));
      orders.back().origin = senders_.origin(reader->handle(), info.publication_handle);
    });
  };
  take_from(motion_requests_);
  take_from(plan_requests_2_);
  take_from(plan_requests_);
  return orders;
}

void ServicePort::look_for_senders() {
  if (!is_open()) return;
  senders_.look({motion_requests_->handle(), plan_requests_2_->handle(), plan_requests_->handle()});
}

std::vector<Relayed> ServicePort::take_relayed() {
  std::vector<Relayed> relayed;
  relayed_by_others_.take_at_most(kAtOnce, [&](const fjr_msg_RelayedRequest& message, const dds_sample_info_t& info) {
    if (info.valid_data) relayed.push_back(decode(message));
  });
  return relayed;
}

std::vector<ServicePort::Cancel> ServicePort::take_cancels() {
  std::vector<Cancel> cancels;
  if (!is_open()) return cancels;
  motion_cancels_->take_at_most(kAtOnce, [&](const fjr_msg_MotionCancel& message, const dds_sample_info_t& info) {
    if (!info.valid_data) return;
    const Origin origin = senders_.origin(motion_cancels_->handle(), info.publication_handle);
    cancels.push_back({decode(message.id), text_of(message.robot_id), origin});
  });
  plan_cancels_->take_at_most(kAtOnce, [&](const fjr_msg_PlanCancel& message, const dds_sample_info_t& info) {
    if (!info.valid_data) return;
    const Origin origin = senders_.origin(plan_cancels_->handle(), info.publication_handle);
    cancels.push_back({decode(message.id), std::nullopt, origin});
  });
  return cancels;
}

std::vector<ServicePort::Peer> ServicePort::take_peers() {
  std::vector<Peer> peers;
  peers_.take_all([&](const fjr_msg_PlannerStatus& message, const dds_sample_info_t& info) {
    if (info.valid_data) peers.push_back({decode(message), alive(info)});
    if (info.valid_data) return;
    peers.push_back({{}, alive(info)});
    peers.back().status.instance = text_of(message.instance);
  });
  return peers;
}

std::vector<Reply> ServicePort::take_replies_of_others() {
  std::vector<Reply> replies;
  replies_of_others_.take_all([&](const fjr_msg_PlanReply& message, const dds_sample_info_t& info) {
    if (info.valid_data) replies.push_back(decode(message));
  });
  return replies;
}

std::vector<ServicePort::Executor> ServicePort::take_executors() {
  std::vector<Executor> executors;
  executors_.take_all([&](const fjr_msg_ExecutorState& message, const dds_sample_info_t& info) {
    if (info.valid_data) executors.push_back({decode(message), alive(info), info.publication_handle});
    if (info.valid_data) return;
    executors.push_back({{}, alive(info), info.publication_handle});
    executors.back().state.robot_id = text_of(message.robot_id);
  });
  return executors;
}

std::vector<ExecutionResult> ServicePort::take_results() {
  std::vector<ExecutionResult> results;
  results_.take_all([&](const fjr_msg_ExecutionResult& message, const dds_sample_info_t& info) {
    if (info.valid_data) results.push_back(decode(message));
  });
  return results;
}

std::vector<ArmDrift> ServicePort::take_drifts() {
  std::vector<ArmDrift> drifts;
  if (!drifts_) return drifts;
  drifts_->take_all([&](const fjr_msg_ArmDrift& message, const dds_sample_info_t& info) {
    if (info.valid_data) drifts.push_back(decode(message));
  });
  return drifts;
}

std::vector<ExecutedRun> ServicePort::take_runs() {
  std::vector<ExecutedRun> runs;
  if (!runs_) return runs;
  runs_->take_all([&](const fjr_msg_ExecutedRun& message, const dds_sample_info_t& info) {
    if (info.valid_data) runs.push_back(decode(message));
  });
  return runs;
}

void ServicePort::send(const ServiceStatus& status) { (void)status_.write(encode(status)); }

// Executors discover the writers in this order, and read fjr/trajectory only from participants that do not write
// fjr/trajectory_2.
void ServicePort::own(std::uint64_t epoch) {
  disown();
  trajectories_2_.emplace(participant_, participant_.handle(), of_owner(epoch));
  trajectories_.emplace(participant_, participant_.handle(), of_owner(epoch));
  learnt_trajectories_ = if_permitted<Writer<fjr_msg_LearntTrajectory>>(
      participant_, TopicOf<fjr_msg_LearntTrajectory>::kName, of_owner(epoch));
}

void ServicePort::disown() {
  learnt_trajectories_.reset();
  trajectories_.reset();
  trajectories_2_.reset();
}

bool ServicePort::learnt_are_taken(ExecutorStates::Source executor) const {
  const auto participant = executors_.participant_of(executor);
  return participant && learnt_trajectories_ && learnt_trajectories_->has_reader_of(*participant);
}

bool ServicePort::send(const TrajectoryOrder& order) {
  if (!trajectories_) return false;
  if (order.learnt) return learnt_trajectories_ && learnt_trajectories_->write(encode_learnt(order));
  const bool sent = trajectories_2_->write(encode_2(order));
  return trajectories_->write(encode(order)) && sent;
}

}  // namespace fjr::dds
