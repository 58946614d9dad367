#include "planner/dds/wire_execution.h"

#include <cstddef>
#include <type_traits>

#include "planner/dds/list.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"
#include "planner/protocol/signature.h"

namespace fjr::dds {
namespace {

// A stop motion on the wire has the same memory layout as StopMotion: fourteen doubles in the same order.
static_assert(sizeof(fjr_msg_StopMotion) == sizeof(StopMotion) && std::is_trivially_copyable_v<StopMotion>);
static_assert(offsetof(fjr_msg_StopMotion, free) == offsetof(StopMotion, free));

// Likewise for a tick: eleven doubles.
static_assert(sizeof(fjr_msg_ExecutedRow) == sizeof(ExecutedRow) && std::is_trivially_copyable_v<ExecutedRow>);
static_assert(offsetof(fjr_msg_ExecutedRow, planned_theta) == offsetof(ExecutedRow, planned_theta));

static_assert(fjr_msg_MAX_SIGNATURE == kLongestSignature && fjr_msg_MAX_CERTIFICATE == kLongestCertificate);

// What all types have.
template <class Message>
void set_members(Message& message, const TrajectoryOrder& order) {
  set_text(message.robot_id, order.robot_id);
  message.id = encode(order.id);
  message.epoch = order.epoch;
  message.published = order.published;
  set_text(message.robot_hash, order.robot_hash);
  set_text(message.request_hash, order.request_hash);
  message.certified = order.certified;
  message.ends_at_rest = order.ends_at_rest;
  set_pair(message.certified_error, order.certified_error);
  set_pair(message.predicted_error, order.predicted_error);
  set_pair(message.tolerances.path, order.tolerances.path);
  set_pair(message.tolerances.goal, order.tolerances.goal);
  message.tolerances.goal_time = order.tolerances.goal_time;
  set_pair(message.tolerances.stopped_velocity, order.tolerances.stopped_velocity);
  point_to(message.rows, order.rows.data(), order.rows.size(), fjr_msg_MAX_ROWS);
}

template <class Message>
TrajectoryOrder order_of(const Message& message) {
  TrajectoryOrder order;
  order.robot_id = text_of(message.robot_id);
  order.id = decode(message.id);
  order.epoch = message.epoch;
  order.published = message.published;
  order.robot_hash = text_of(message.robot_hash);
  order.request_hash = text_of(message.request_hash);
  order.certified = message.certified;
  order.ends_at_rest = message.ends_at_rest;
  order.certified_error = pair_of(message.certified_error);
  order.predicted_error = pair_of(message.predicted_error);
  order.tolerances.path = pair_of(message.tolerances.path);
  order.tolerances.goal = pair_of(message.tolerances.goal);
  order.tolerances.goal_time = message.tolerances.goal_time;
  order.tolerances.stopped_velocity = pair_of(message.tolerances.stopped_velocity);
  copy_list(message.rows, order.rows);
  return order;
}

// What the signed types have.
template <class Message>
Message signed_message(const TrajectoryOrder& order) {
  Message message{};
  set_members(message, order);
  point_to(message.stops, order.stops.data(), order.stops.size(), fjr_msg_MAX_STOPS);
  point_to(message.signature, order.signature.value.data(), order.signature.value.size(), fjr_msg_MAX_SIGNATURE);
  point_to(message.signer, order.signature.signer.data(), order.signature.signer.size(), fjr_msg_MAX_CERTIFICATE);
  return message;
}

template <class Message>
TrajectoryOrder signed_order_of(const Message& message) {
  TrajectoryOrder order = order_of(message);
  copy_list(message.stops, order.stops);
  copy_list(message.signature, order.signature.value);
  copy_list(message.signer, order.signature.signer);
  return order;
}

}  // namespace

fjr_msg_Trajectory encode(const TrajectoryOrder& order) {
  fjr_msg_Trajectory message{};
  set_members(message, order);
  return message;
}

TrajectoryOrder decode(const fjr_msg_Trajectory& message) { return order_of(message); }

fjr_msg_Trajectory2 encode_2(const TrajectoryOrder& order) { return signed_message<fjr_msg_Trajectory2>(order); }

TrajectoryOrder decode(const fjr_msg_Trajectory2& message) { return signed_order_of(message); }

fjr_msg_LearntTrajectory encode_learnt(const TrajectoryOrder& order) {
  return signed_message<fjr_msg_LearntTrajectory>(order);
}

TrajectoryOrder decode(const fjr_msg_LearntTrajectory& message) {
  TrajectoryOrder order = signed_order_of(message);
  order.learnt = true;
  return order;
}

fjr_msg_ExecutorState encode(const ExecutorState& state) {
  fjr_msg_ExecutorState message{};
  set_text(message.robot_id, state.robot_id);
  set_text(message.robot_hash, state.robot_hash);
  message.mode = static_cast<std::uint8_t>(state.mode);
  message.trajectory_id = encode(state.trajectory_id);
  message.epoch = state.epoch;
  message.stamp = state.stamp;
  message.time = state.time;
  set_pair(message.q, state.q);
  set_pair(message.theta, state.theta);
  set_pair(message.dq, state.dq);
  set_pair(message.dtheta, state.dtheta);
  set_pair(message.planned_q, state.planned_q);
  set_pair(message.torque, state.torque);
  set_pair(message.feedback, state.feedback);
  return message;
}

ExecutorState decode(const fjr_msg_ExecutorState& message) {
  ExecutorState state;
  state.robot_id = text_of(message.robot_id);
  state.robot_hash = text_of(message.robot_hash);
  state.mode = static_cast<ExecutorMode>(message.mode);
  state.trajectory_id = decode(message.trajectory_id);
  state.epoch = message.epoch;
  state.stamp = message.stamp;
  state.time = message.time;
  state.q = pair_of(message.q);
  state.theta = pair_of(message.theta);
  state.dq = pair_of(message.dq);
  state.dtheta = pair_of(message.dtheta);
  state.planned_q = pair_of(message.planned_q);
  state.torque = pair_of(message.torque);
  state.feedback = pair_of(message.feedback);
  return state;
}

fjr_msg_ExecutorCommand encode(const ExecutorOrder& order) {
  fjr_msg_ExecutorCommand message{};
  set_text(message.robot_id, order.robot_id);
  message.id = encode(order.id);
  message.command = static_cast<std::uint8_t>(order.command);
  return message;
}

std::optional<ExecutorOrder> decode(const fjr_msg_ExecutorCommand& message) {
  if (message.command != fjr_msg_COMMAND_HOLD && message.command != fjr_msg_COMMAND_STOP) return std::nullopt;
  return ExecutorOrder{text_of(message.robot_id), decode(message.id), static_cast<ExecutorCommand>(message.command)};
}

WireResult encode(const ExecutionResult& result) {
  WireResult wire;
  for (const LimitMargin& margin : result.limits) {
    if (wire.limits.size() == fjr_msg_MAX_LIMIT_CHECKS) break;
    fjr_msg_LimitMargin& to = wire.limits.emplace_back();
    set_text(to.name, margin.name);
    to.joint = static_cast<std::uint8_t>(margin.joint);
    to.limit = margin.limit;
    to.reached = margin.reached;
  }
  fjr_msg_ExecutionResult& message = wire.message;
  set_text(message.robot_id, result.robot_id);
  message.trajectory_id = encode(result.trajectory_id);
  message.error_code = static_cast<std::int32_t>(result.code);
  set_text(message.sentence, result.sentence);
  set_pair(message.link_error, result.link_error);
  set_pair(message.link_error_rms, result.link_error_rms);
  set_pair(message.final_link_error, result.final_link_error);
  set_pair(message.residual_vibration, result.residual_vibration);
  set_pair(message.feedback_torque, result.feedback_torque);
  message.limits._length = message.limits._maximum = static_cast<std::uint32_t>(wire.limits.size());
  message.limits._buffer = wire.limits.data();
  set_text(message.log_file, result.log_file);
  return wire;
}

ExecutionResult decode(const fjr_msg_ExecutionResult& message) {
  ExecutionResult result;
  result.robot_id = text_of(message.robot_id);
  result.trajectory_id = decode(message.trajectory_id);
  result.code = static_cast<ResultCode>(message.error_code);
  result.sentence = text_of(message.sentence);
  result.link_error = pair_of(message.link_error);
  result.link_error_rms = pair_of(message.link_error_rms);
  result.final_link_error = pair_of(message.final_link_error);
  result.residual_vibration = pair_of(message.residual_vibration);
  result.feedback_torque = pair_of(message.feedback_torque);
  for (std::uint32_t i = 0; i < message.limits._length; ++i) {
    const fjr_msg_LimitMargin& margin = message.limits._buffer[i];
    result.limits.push_back({text_of(margin.name), margin.joint, margin.limit, margin.reached});
  }
  result.log_file = text_of(message.log_file);
  return result;
}

fjr_msg_ExecutedRun encode(const ExecutedRun& run) {
  fjr_msg_ExecutedRun message{};
  set_text(message.robot_id, run.robot_id);
  set_text(message.robot_hash, run.robot_hash);
  message.trajectory_id = encode(run.trajectory_id);
  message.error_code = static_cast<std::int32_t>(run.code);
  set_text(message.sentence, run.sentence);
  message.missed_ticks = run.missed_ticks;
  point_to(message.rows, run.rows.data(), run.rows.size(), fjr_msg_MAX_ROWS);
  return message;
}

ExecutedRun decode(const fjr_msg_ExecutedRun& message) {
  ExecutedRun run;
  run.robot_id = text_of(message.robot_id);
  run.robot_hash = text_of(message.robot_hash);
  run.trajectory_id = decode(message.trajectory_id);
  run.code = static_cast<ResultCode>(message.error_code);
  run.sentence = text_of(message.sentence);
  run.missed_ticks = message.missed_ticks;
  copy_list(message.rows, run.rows);
  return run;
}

fjr_msg_ArmDrift encode(const ArmDrift& drift) {
  fjr_msg_ArmDrift message{};
  set_text(message.robot_id, drift.robot_id);
  set_text(message.robot_hash, drift.robot_hash);
  message.motions = drift.motions;
  message.drifts = drift.drifts;
  message.evidence = drift.evidence;
  message.alarm = drift.alarm;
  set_text(message.parameter, drift.parameter);
  set_text(message.unit, drift.unit);
  message.share = drift.share;
  message.known = drift.known;
  message.change = drift.change;
  message.change_error = drift.change_error;
  message.since = encode(drift.since);
  message.motions_since = drift.motions_since;
  return message;
}

ArmDrift decode(const fjr_msg_ArmDrift& message) {
  ArmDrift drift;
  drift.robot_id = text_of(message.robot_id);
  drift.robot_hash = text_of(message.robot_hash);
  drift.motions = message.motions;
  drift.drifts = message.drifts;
  drift.evidence = message.evidence;
  drift.alarm = message.alarm;
  drift.parameter = text_of(message.parameter);
  drift.unit = text_of(message.unit);
  drift.share = message.share;
  drift.known = message.known;
  drift.change = message.change;
  drift.change_error = message.change_error;
  drift.since = decode(message.since);
  drift.motions_since = message.motions_since;
  return drift;
}

}  // namespace fjr::dds
