// Outgoing replies to clients and trajectories to the executor.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "planner/service/durations.h"
#include "planner/service/service.h"
#include "planner/service/version.h"

namespace fjr {

Reply Service::reply_to(const Order& order, ReplyState state, Refusal why) const {
  Reply reply;
  reply.id = reply.motion = order.id;
  reply.state = state;
  reply.why = std::move(why);
  reply.robot_id = config_.robot_id;
  reply.robot_hash = robot_hash_;
  reply.version = program_version();
  reply.origin = order.origin;
  return reply;
}

// Returns why certified rows must not move the arm now, or nothing if they may. The rows are never empty.
std::optional<Refusal> Service::refusal_to_publish(const std::vector<Sample>& rows, bool learnt) const {
  if (const auto twice = executor_.twice()) {
    return Refusal{Reason::kArmNotAtRest, "", "planned, but not executed: " + *twice};
  }
  if (learnt) {
    if (auto refusal = refusal_of_learnt()) return refusal;
  }
  if (rows.back().time <= kLongestMotion) return std::nullopt;
  return Refusal{Reason::kUnsupported, "duration",
                 fmt::format("planned, but not executed: it takes {:.6g} s, and an executor runs at most {:g} s",
                             rows.back().time, kLongestMotion)};
}

void Service::finish(const Job& job, Reply reply) {
  if (job.planned) reply.motion = job.planned->motion;
  reply.learnt = job.run || (job.planned && job.planned->learnt);
  if (executes(job.order) && reply.state == ReplyState::kSolved) {
    if (auto refusal = refusal_to_publish(reply.rows, reply.learnt)) {
      reply = reply_to(job.order, ReplyState::kFailed, std::move(*refusal));
    }
  }
  const auto now = Clock::now();
  const bool started = job.started != Clock::time_point{};
  reply.request_hash = job.request_hash;
  if (!job.robot_hash.empty()) reply.robot_hash = job.robot_hash;
  reply.rest_to_rest = job.rest_to_rest;
  reply.solve_time = started ? seconds(now - job.started) : 0;
  reply.wait_time = seconds((started ? job.started : now) - job.arrived);
  const auto shared = std::make_shared<const Reply>(std::move(reply));
  settle({job.order, job.arrived, shared});
  if (log_requests_.allows()) {
    spdlog::info("finished id={} state={} wait={:.3f} solve={:.3f} {}", text(shared->id), name(shared->state),
                 shared->wait_time, shared->solve_time, shared->why.sentence);
  }
}

void Service::give_up(const Job& job, ReplyState state, Reason reason, const std::string& sentence) {
  finish(job, reply_to(job.order, state, {reason, "", sentence}));
}

// Remembers a reply. A temporary refusal is not remembered, so that the client may ask again. Its id is, so that a copy
// relayed by a standby does not count as a new request.
void Service::remember(const SharedReply& reply) {
  if (!lasting(reply->why.reason)) return refused_lately_.add(reply->id, reply->origin, Clock::now());
  for (const RequestId& forgotten : cache_.add(reply)) {
    if (store_) store_->forget(forgotten);
  }
}

void Service::reject(const Order& order, Refusal why) {
  const auto reply = std::make_shared<const Reply>(reply_to(order, ReplyState::kRejected, std::move(why)));
  settle({order, Clock::now(), reply});
  if (log_refusals_.allows()) {
    spdlog::info("rejected id={} field={} {}", text(order.id), reply->why.field, reply->why.sentence);
  }
}

// Sends a final reply. If replies are remembered over a restart, it is stored on disk first, so that a client never
// gets two different replies.
void Service::settle(Answer answer) {
  if (!store_ || !lasting(answer.reply->why.reason)) return release(answer);
  store_->add(answer.reply);
  being_stored_.push_back(std::move(answer));
  release_stored();
}

void Service::release(const Answer& answer) {
  remember(answer.reply);
  tally_.count(*answer.reply, seconds(Clock::now() - answer.arrived));
  if (executes(answer.order) && answer.reply->state == ReplyState::kSolved) publish(*answer.reply);
  post(answer.reply);
}

// Releases a reply that was being stored. Its client may have gone meanwhile: then no arm is moved for it.
void Service::release_if_it_may_start(Answer answer) {
  const bool moves = executes(answer.order) && answer.reply->state == ReplyState::kSolved;
  if (moves && !may_start(answer.order)) {
    store_->forget(answer.reply->id);
    answer.reply = std::make_shared<const Reply>(reply_to(answer.order, ReplyState::kCancelled, client_gone()));
  }
  release(answer);
}

// Sends the replies that are on disk by now.
void Service::release_stored() {
  if (!store_) return;
  for (const RequestId& id : store_->take_settled()) {
    const auto stored = std::find_if(being_stored_.begin(), being_stored_.end(),
                                     [&](const Answer& answer) { return answer.reply->id == id; });
    if (stored == being_stored_.end()) continue;  // an overheard reply, which is not sent
    Answer answer = std::move(*stored);
    being_stored_.erase(stored);
    release_if_it_may_start(std::move(answer));
  }
}

void Service::await_stored(Clock::time_point over) {
  for (release_stored(); !being_stored_.empty() && Clock::now() < over; release_stored()) {
    port_.wait(std::chrono::milliseconds(1));
  }
  if (!being_stored_.empty()) spdlog::warn("{} replies leave before they are on disk", being_stored_.size());
  for (Answer& answer : std::exchange(being_stored_, {})) release_if_it_may_start(std::move(answer));
}

bool Service::being_stored(const RequestId& id) const {
  return std::any_of(being_stored_.begin(), being_stored_.end(),
                     [&](const Answer& answer) { return answer.reply->id == id; });
}

// Publishes a trajectory to the executor. Only certified ones have rows. The trajectory of a repeated request is never
// published again, nor one that an earlier owner published before it could reply.
void Service::publish(const Reply& reply) {
  if (executor_.runs_or_ran(reply.id)) return spdlog::info("published before id={}", text(reply.id));
  TrajectoryOrder order;
  order.robot_id = config_.robot_id;
  order.id = reply.id;
  order.epoch = ownership_.epoch();
  order.published = executor_.stamp();
  order.robot_hash = reply.robot_hash;
  order.request_hash = reply.request_hash;
  order.certified = reply.state == ReplyState::kSolved;
  order.ends_at_rest = reply.rest_to_rest;
  order.certified_error = reply.errors.certified;
  order.predicted_error = reply.errors.predicted;
  order.rows = reply.rows;
  order.stops = reply.stops;
  order.learnt = reply.learnt;
  if (signer_) order.signature = signer_->sign(signed_bytes(order));
  executor_.published(reply.id);
  if (!port_.send(order) && log_requests_.allows()) {
    spdlog::error("perhaps not published id={}: a reader of the trajectories has no room for it", text(reply.id));
  }
  if (ros_) ros_->send(order);
}

// Returns false if the client has no room for the reply now.
bool Service::send(const SharedReply& reply) {
  switch (port_.clients().send(*reply)) {
    case dds::Sent::kYes:
      return true;
    case dds::Sent::kNoRoom:
      return false;
    case dds::Sent::kNobodyListens:
      port_.clients().tell_standbys(*reply);
      unclaimed_.keep(reply);
      return true;
  }
  return true;
}

void Service::post(SharedReply reply) {
  const RequestId id = reply->id;
  if (!outbox_.post(std::move(reply)) && log_slow_clients_.allows()) {
    spdlog::warn("slow clients: too many replies wait, after id={} the oldest is dropped", text(id));
  }
}

}  // namespace fjr
