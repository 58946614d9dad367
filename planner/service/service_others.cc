// Other instances and the executor: ownership of the robot, and relayed requests.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "common/input_error.h"
#include "planner/service/durations.h"
#include "planner/service/frames.h"
#include "planner/service/overheard.h"
#include "planner/service/service.h"

namespace fjr {
namespace {

constexpr std::size_t kAnsweredAtOnce =
    4;  // of what was remembered, in a turn; a document takes up to 40 ms to be read

// Returns whether a relayed order contains a request, and is not only a cancellation.
bool asks(const Order& order) { return order.action != Action::kPlan || order.motion || !order.document.empty(); }

}  // namespace

void Service::listen_to_others() {
  for (const auto& peer : port_.take_peers()) hear(peer);
  for (Reply& reply : port_.take_replies_of_others()) hear(std::move(reply));
  for (dds::Relayed& relayed : port_.take_relayed()) hear(std::move(relayed));
  for (const auto& executor : port_.take_executors()) {
    executor.alive ? executor_.heard(executor.state, executor.source) : executor_.lost(executor.state.robot_id);
  }
  for (const ExecutionResult& result : port_.take_results()) hear(result);
  for (ArmDrift& drift : port_.take_drifts()) hear(std::move(drift));
  for (ExecutedRun& run : port_.take_runs()) hear(std::move(run));
  if (const auto epoch = executor_.epoch()) ownership_.heard_executor(*epoch);
  if (settled()) review_ownership();
}

void Service::hear(const dds::ServicePort::Peer& peer) {
  const ServiceStatus& status = peer.status;
  if (status.instance == config_.instance) {
    const std::string problem = fmt::format("another service is running as instance {} on DDS domain {}",
                                            config_.instance, config_.network.domain);
    if (!port_.is_open() && peer.alive) throw std::runtime_error(problem);
    if (log_others_.allows()) spdlog::error(problem);
  } else if (!peer.alive) {
    if (log_others_.allows()) spdlog::info("instance gone name={}", status.instance);
    ownership_.lost(status.instance);
  } else if (status.robot_id == config_.robot_id && !ownership_.believes(status.epoch)) {
    if (log_others_.allows()) {
      spdlog::warn("instance not believed name={} epoch={}: far above what the executor has seen", status.instance,
                   status.epoch);
    }
  } else if (!status.robot_id.empty() && takes_part(status)) {
    ownership_.heard(status.instance, status.robot_id, status.epoch);
  }
}

// Logs the drift of the arm only if the verdict changes, because a drifting arm is reported after every motion.
void Service::hear(ArmDrift drift) {
  if (drift.robot_id != config_.robot_id) return;
  const auto level = drift.drifts ? spdlog::level::warn : spdlog::level::info;
  if (news(drift_, drift)) spdlog::log(level, "arm of robot={} {}", drift.robot_id, sentence_of(drift));
  drift_ = std::move(drift);
}

void Service::hear(Reply reply) {
  if (!reply.final()) return backlog_.accepted(reply.id);
  reply.origin = backlog_.answered(reply.id);
  const bool of_this_robot = reply.robot_id == config_.robot_id && reply.robot_hash == robot_hash_;
  if (!of_this_robot || !lasting(reply.why.reason) || cache_.find(reply.id)) return;
  complete(reply);
  const auto shared = std::make_shared<const Reply>(std::move(reply));
  if (store_) store_->add(shared);
  remember(shared);
}

// Completes an overheard reply. A plan that is executed again is recognised by its samples.
void Service::complete(Reply& reply) const {
  complete_overheard(reply);
  if (reply.learnt) return;
  const SharedReply before = cache_.find_trajectory([&](const Reply& earlier) {
    return earlier.request_hash == reply.request_hash && as_payload(earlier.rows) == as_payload(reply.rows);
  });
  if (before) reply.motion = before->motion;
}

// Handles a request that another instance relays, whose client may have discovered only that instance.
void Service::hear(dds::Relayed relayed) {
  const auto now = Clock::now();
  const auto heard = now - duration_of(relayed.silence);
  const RequestId id = relayed.order.id;
  // A copy that arrives after the reply, to a client that listens, is not a new request.
  const bool told = cache_.find(id) && port_.clients().listens(id);
  if (told && ownership_.answers_for(relayed.order.robot_id)) return;
  const dds::ServicePort::Cancel wanted{id, relayed.order.robot_id, relayed.order.origin};
  if (relayed.cancelled && !asks(relayed.order)) {
    return ownership_.owner() ? cancel(wanted) : keep_cancel(wanted, false);
  }
  note_what_it_needs(relayed.order);
  if (!answers(relayed.order)) {
    keep(std::move(relayed.order), now, heard, false);
    if (relayed.cancelled) keep_cancel(wanted, false);
    return;
  }
  if (refused_lately_.contains(id, now)) return;  // its client has been told; to ask again is the client's to decide
  admit(std::move(relayed.order), now, heard);
  if (relayed.cancelled) cancel(wanted);
}

void Service::relay() {
  if (ownership_.alone()) return;
  const auto now = Clock::now();
  backlog_.relay_due(now, [&](const Backlog::Entry& entry) {
    port_.relay({entry.order, seconds(now - entry.heard), entry.cancelled});
  });
}

// Returns whether another instance counts as serving its robot. If it serves this robot with a different robot file, it
// counts only while it is the owner. Plans of one could not be executed by the other, so one of the two must not serve:
// if it is this one, throws InputError.
bool Service::takes_part(const ServiceStatus& other) const {
  if (other.robot_id != config_.robot_id || other.robot_hash == robot_hash_) return true;
  const bool owns = other.epoch > 0;
  if (!ownership_.owner() && (owns || !ownership_.goes_before(other.instance))) {
    throw InputError(config_.robot.string(), "",
                     fmt::format("robot_id {} is served by instance {} with another robot (hash {}, here {}): give "
                                 "both the same file, or this one a robot_id of its own",
                                 config_.robot_id, other.instance, other.robot_hash, robot_hash_));
  }
  return owns;
}

// Begins to answer, but not before the other instances are known, so that no request is answered twice.
void Service::open() {
  port_.open();
  spdlog::info("serving instance={} domain={} workers={} queue={} robot={} {}", config_.instance,
               config_.network.domain, config_.workers, config_.queue, robot_hash_.substr(0, 12),
               ownership_.owner() ? "as owner" : "as standby");
  companion_.tell_ready();
}

void Service::review_ownership() {
  const bool changed = ownership_.review();
  if (!port_.is_open()) open();
  if (changed) {
    ownership_.owner() ? take_over() : give_up_ownership();
    next_heartbeat_ = {};  // the others are told at once
  }
  if (ownership_.owner()) answer_backlog();
}

void Service::take_over() {
  spdlog::info("owner robot_id={} epoch={} remembered={}", config_.robot_id, ownership_.epoch(), backlog_.size());
  port_.own(ownership_.epoch());
  solvers_.own(port_.participant(), port_.waitset(), {config_.instance, config_.robot_id, robot_hash_},
               ownership_.epoch());
  if (!owned_) took_over_at_ = Clock::now();  // otherwise only its epoch has grown
  owned_ = true;
}

// Answers requests that arrived while there was another owner or none, or before the executor was heard. Only some are
// answered at a time, because there may be many. The client of a request from before the take-over may be gone, so the
// arm does not move for it until the client has acknowledged a reply of this instance.
void Service::answer_backlog() {
  std::size_t count = 0;
  const auto ours = [&](const Backlog::Entry& entry) {
    return count < kAnsweredAtOnce && answers(entry) && ++count > 0;
  };
  for (Backlog::Entry& entry : backlog_.take_if(ours)) {
    const auto heard = entry.heard < took_over_at_ ? Clock::time_point{} : entry.heard;
    entry.cancelled ? conclude(entry) : admit(std::move(entry.order), entry.arrived, heard);
  }
  answering_ = count == kAnsweredAtOnce;
}

// Gives up the ownership. The new owner has heard the same requests, so they are not answered here.
void Service::give_up_ownership() {
  spdlog::warn("superseded robot_id={}", config_.robot_id);
  port_.disown();
  owned_ = false;
  const auto put_back = [this](Job job) {
    const auto heard = presence_.last_heard(job.order.id);
    keep(std::move(job.order), job.arrived, heard, true);
  };
  while (auto job = solvers_.stop_if([](const Job&) { return true; })) put_back(std::move(*job));
  solvers_.disown();
  while (!queue_.empty()) put_back(queue_.pop());
  for (Answer& answer : std::exchange(being_stored_, {})) {
    store_->forget(answer.reply->id);
    keep(std::move(answer.order), answer.arrived, presence_.last_heard(answer.reply->id), true);
  }
}

}  // namespace fjr
