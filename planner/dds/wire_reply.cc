#include "planner/dds/wire_reply.h"

#include <cstddef>
#include <type_traits>

#include "planner/dds/list.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"
#include "planner/trajectory/finite.h"

namespace fjr::dds {
namespace {

// A row on the wire has the same memory layout as Sample: eleven doubles in the same order.
static_assert(sizeof(fjr_msg_Row) == sizeof(Sample) && std::is_trivially_copyable_v<Sample>);
static_assert(offsetof(fjr_msg_Row, tau) == offsetof(Sample, torque));
static_assert(kMaxRows == fjr_msg_MAX_ROWS);
static_assert(kLongestPlanJson == fjr_msg_MAX_PLAN_JSON);

static_assert(static_cast<int>(ReplyState::kAccepted) == fjr_msg_STATE_ACCEPTED);
static_assert(static_cast<int>(ReplyState::kExpired) == fjr_msg_STATE_EXPIRED);
static_assert(static_cast<int>(Reason::kBadInput) == fjr_msg_REASON_BAD_INPUT);
static_assert(static_cast<int>(Reason::kClientGone) == fjr_msg_REASON_CLIENT_GONE);

}  // namespace

fjr_msg_PlanReply encode(const Reply& reply) {
  fjr_msg_PlanReply message{};
  message.id = encode(reply.id);
  message.state = static_cast<std::uint8_t>(reply.state);
  message.reason = static_cast<std::uint8_t>(reply.why.reason);
  set_text(message.field, reply.why.field);
  set_text(message.sentence, reply.why.sentence);
  set_text(message.robot_id, reply.robot_id);
  set_text(message.robot_hash, reply.robot_hash);
  set_text(message.request_hash, reply.request_hash);
  set_text(message.version, reply.version);
  message.solve_time = reply.solve_time;
  message.wait_time = reply.wait_time;
  point_to(message.plan_json, reply.plan_json.data(), reply.plan_json.size(), fjr_msg_MAX_PLAN_JSON);
  point_to(message.rows, reply.rows.data(), reply.rows.size(), fjr_msg_MAX_ROWS);
  return message;
}

Reply decode(const fjr_msg_PlanReply& message) {
  Reply reply;
  reply.id = decode(message.id);
  reply.state = static_cast<ReplyState>(message.state);
  reply.why = {static_cast<Reason>(message.reason), text_of(message.field), text_of(message.sentence)};
  reply.robot_id = text_of(message.robot_id);
  reply.robot_hash = text_of(message.robot_hash);
  reply.request_hash = text_of(message.request_hash);
  reply.version = text_of(message.version);
  reply.solve_time = message.solve_time;
  reply.wait_time = message.wait_time;
  reply.plan_json = printable_lines(bytes_of(message.plan_json));
  copy_list(message.rows, reply.rows);
  if (reply.state == ReplyState::kSolved && (reply.rows.empty() || !all_finite(reply.rows))) {
    reply.state = ReplyState::kFailed;
    reply.why = {Reason::kNoTrajectory, "", "the reply says SOLVED, and has no trajectory, or one with a NaN"};
    reply.rows.clear();
  }
  return reply;
}

fjr_msg_PlanStatus encode(const ProgressReport& report) {
  fjr_msg_PlanStatus message{};
  message.id = encode(report.id);
  message.queue_position = report.queue_position;
  set_text(message.stage, report.progress.stage);
  message.iteration = static_cast<std::uint32_t>(report.progress.iteration);
  message.objective = report.progress.objective;
  message.violation = report.progress.violation;
  message.elapsed = report.elapsed;
  return message;
}

ProgressReport decode(const fjr_msg_PlanStatus& message) {
  ProgressReport report;
  report.id = decode(message.id);
  report.queue_position = message.queue_position;
  report.progress = {text_of(message.stage), static_cast<int>(message.iteration), message.objective, message.violation};
  report.elapsed = message.elapsed;
  return report;
}

fjr_msg_PlannerStatus encode(const ServiceStatus& status) {
  fjr_msg_PlannerStatus message{};
  set_text(message.instance, status.instance);
  set_text(message.robot_id, status.robot_id);
  set_text(message.robot_hash, status.robot_hash);
  set_text(message.version, status.version);
  message.epoch = status.epoch;
  message.uptime = status.uptime;
  message.queued = status.queued;
  message.queue_capacity = status.queue_capacity;
  message.workers = status.workers;
  message.solving = status.solving;
  message.workers_lost = status.workers_lost;
  message.received = status.received;
  message.duplicates = status.duplicates;
  message.solved = status.solved;
  message.rejected = status.rejected;
  message.infeasible = status.infeasible;
  message.failed = status.failed;
  message.cancelled = status.cancelled;
  message.expired = status.expired;
  message.latency_p50 = status.latency_p50;
  message.latency_p90 = status.latency_p90;
  message.latency_p99 = status.latency_p99;
  message.memory = status.memory;
  return message;
}

ServiceStatus decode(const fjr_msg_PlannerStatus& message) {
  ServiceStatus status;
  status.instance = text_of(message.instance);
  status.robot_id = text_of(message.robot_id);
  status.robot_hash = text_of(message.robot_hash);
  status.version = text_of(message.version);
  status.epoch = message.epoch;
  status.uptime = message.uptime;
  status.queued = message.queued;
  status.queue_capacity = message.queue_capacity;
  status.workers = message.workers;
  status.solving = message.solving;
  status.workers_lost = message.workers_lost;
  status.received = message.received;
  status.duplicates = message.duplicates;
  status.solved = message.solved;
  status.rejected = message.rejected;
  status.infeasible = message.infeasible;
  status.failed = message.failed;
  status.cancelled = message.cancelled;
  status.expired = message.expired;
  status.latency_p50 = message.latency_p50;
  status.latency_p90 = message.latency_p90;
  status.latency_p99 = message.latency_p99;
  status.memory = message.memory;
  return status;
}

}  // namespace fjr::dds
