#include "planner/dds/wire_work.h"

#include <algorithm>

#include "planner/dds/list.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"
#include "planner/trajectory/finite.h"

namespace fjr::dds {
namespace {

static_assert(kMaxHeld == fjr_msg_MAX_HELD);
static_assert(static_cast<int>(LeaseKind::kGranted) == fjr_msg_LEASE_GRANTED);
static_assert(static_cast<int>(LeaseKind::kRefused) == fjr_msg_LEASE_REFUSED);
static_assert(static_cast<int>(RefusedFor::kVersion) == fjr_msg_REFUSED_VERSION);
static_assert(static_cast<int>(WorkOutcome::kDone) == fjr_msg_WORK_DONE);
static_assert(static_cast<int>(WorkOutcome::kReturned) == fjr_msg_WORK_RETURNED);
static_assert(sizeof(fjr_msg_Row) == sizeof(Sample) && sizeof(fjr_msg_StopMotion) == sizeof(StopMotion));

fjr_msg_LeaseId encode(const LeaseId& id) {
  fjr_msg_LeaseId message{};
  std::copy(id.owner.begin(), id.owner.end(), message.owner);
  message.epoch = id.epoch;
  message.number = id.number;
  return message;
}

LeaseId decode(const fjr_msg_LeaseId& message) {
  LeaseId id;
  std::copy(std::begin(message.owner), std::end(message.owner), id.owner.begin());
  id.epoch = message.epoch;
  id.number = message.number;
  return id;
}

fjr_msg_HeldLease encode(const HeldLease& held) {
  fjr_msg_HeldLease message{};
  message.lease = encode(held.lease);
  set_text(message.stage, held.progress.stage);
  message.iteration = static_cast<std::uint32_t>(held.progress.iteration);
  message.objective = held.progress.objective;
  message.violation = held.progress.violation;
  return message;
}

HeldLease decode(const fjr_msg_HeldLease& message) {
  return {decode(message.lease),
          {text_of(message.stage), static_cast<int>(message.iteration), message.objective, message.violation}};
}

// Returns whether a result is consistent: outcome, state and reason are known ones, the state is final, the rows are
// finite, and there are rows if and only if it is solved.
bool makes_sense(const WorkResult& result) {
  const bool known = result.outcome >= WorkOutcome::kDone && result.outcome <= WorkOutcome::kReturned &&
                     result.state >= ReplyState::kRejected && result.state <= ReplyState::kExpired &&
                     result.why.reason <= Reason::kClientGone;
  return known && (result.state == ReplyState::kSolved) == !result.rows.empty() && all_finite(result.rows);
}

}  // namespace

WireOffer encode(const WorkerOffer& offer) {
  WireOffer wire;
  for (const HeldLease& held : offer.held) {
    if (wire.held.size() < fjr_msg_MAX_HELD) wire.held.push_back(encode(held));
  }
  fjr_msg_WorkerOffer& message = wire.message;
  std::copy(offer.worker.begin(), offer.worker.end(), message.worker);
  set_text(message.instance, offer.instance);
  set_text(message.robot_id, offer.robot_id);
  set_text(message.robot_hash, offer.robot_hash);
  set_text(message.version, offer.version);
  message.slots = offer.slots;
  message.held._length = message.held._maximum = static_cast<std::uint32_t>(wire.held.size());
  message.held._buffer = wire.held.data();
  return wire;
}

WorkerOffer decode(const fjr_msg_WorkerOffer& message) {
  WorkerOffer offer;
  std::copy(std::begin(message.worker), std::end(message.worker), offer.worker.begin());
  offer.instance = text_of(message.instance);
  offer.robot_id = text_of(message.robot_id);
  offer.robot_hash = text_of(message.robot_hash);
  offer.version = text_of(message.version);
  offer.slots = std::min<std::uint32_t>(message.slots, kMaxSlots);
  for (std::uint32_t i = 0; i < message.held._length; ++i) offer.held.push_back(decode(message.held._buffer[i]));
  return offer;
}

fjr_msg_WorkLease encode(const LeaseWord& word) {
  fjr_msg_WorkLease message{};
  message.lease = encode(word.lease);
  message.kind = static_cast<std::uint8_t>(word.kind);
  set_text(message.instance, word.instance);
  message.refused = static_cast<std::uint8_t>(word.refused);
  set_text(message.sentence, word.sentence);
  message.id = encode(word.id);
  set_text(message.name, word.name);
  message.executes = word.executes;
  point_to(message.document, word.document.data(), word.document.size(), fjr_msg_MAX_DOCUMENT);
  point_to(message.rows, word.rows.data(), word.rows.size(), fjr_msg_MAX_ROWS);
  return message;
}

LeaseWord decode(const fjr_msg_WorkLease& message) {
  LeaseWord word;
  word.lease = decode(message.lease);
  word.kind = static_cast<LeaseKind>(message.kind);
  word.instance = text_of(message.instance);
  word.refused = static_cast<RefusedFor>(message.refused);
  word.sentence = text_of(message.sentence);
  word.id = decode(message.id);
  word.name = text_of(message.name);
  word.executes = message.executes;
  word.document = bytes_of(message.document);
  copy_list(message.rows, word.rows);
  return word;
}

fjr_msg_WorkResult encode(const WorkResult& result) {
  fjr_msg_WorkResult message{};
  message.lease = encode(result.lease);
  std::copy(result.worker.begin(), result.worker.end(), message.worker);
  message.outcome = static_cast<std::uint8_t>(result.outcome);
  message.state = static_cast<std::uint8_t>(result.state);
  message.reason = static_cast<std::uint8_t>(result.why.reason);
  set_text(message.sentence, result.why.sentence);
  set_pair(message.certified_error, result.errors.certified);
  set_pair(message.predicted_error, result.errors.predicted);
  point_to(message.plan_json, result.plan_json.data(), result.plan_json.size(), fjr_msg_MAX_PLAN_JSON);
  point_to(message.rows, result.rows.data(), result.rows.size(), fjr_msg_MAX_ROWS);
  point_to(message.stops, result.stops.data(), result.stops.size(), fjr_msg_MAX_STOPS);
  return message;
}

WorkResult decode(const fjr_msg_WorkResult& message) {
  WorkResult result;
  result.lease = decode(message.lease);
  std::copy(std::begin(message.worker), std::end(message.worker), result.worker.begin());
  result.outcome = static_cast<WorkOutcome>(message.outcome);
  result.state = static_cast<ReplyState>(message.state);
  result.why = {static_cast<Reason>(message.reason), "", text_of(message.sentence)};
  result.errors = {pair_of(message.certified_error), pair_of(message.predicted_error)};
  result.plan_json = printable_lines(bytes_of(message.plan_json));
  copy_list(message.rows, result.rows);
  copy_list(message.stops, result.stops);
  if (makes_sense(result)) return result;
  WorkResult lost;
  lost.lease = result.lease;
  lost.worker = result.worker;
  lost.outcome = WorkOutcome::kLost;
  return lost;
}

}  // namespace fjr::dds
