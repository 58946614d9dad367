#include "planner/service/service.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "planner/service/durations.h"
#include "planner/service/memory.h"
#include "planner/service/version.h"

namespace fjr {
namespace {

constexpr std::chrono::milliseconds kHeartbeat{150};
constexpr std::chrono::milliseconds kLease{500};     // topics.h: silent for longer, an instance counts as gone
constexpr std::chrono::milliseconds kSettle{250};    // to hear of other instances, which takes 13 ms on an idle machine
constexpr std::chrono::milliseconds kGlance{5};      // how often it looks at them meanwhile
constexpr std::chrono::milliseconds kAnswerSoon{5};  // how often it looks whether a client that was asked is there
constexpr std::chrono::seconds kUnclaimedFor{60};    // replies wait for clients that do not listen yet
constexpr std::size_t kRemembered = 256;             // replies of each kind kept for repeated requests
constexpr std::size_t kRememberedBytes = 32 << 20;
constexpr std::size_t kRefusedLately = 4096;                              // ids
constexpr std::chrono::seconds kRelaysEnd{5};                             // a standby passes a request on for about 2 s
constexpr std::size_t kUnclaimedOfOne = 128, kUnclaimedBytes = 16 << 20;  // clients of one participant; of all
constexpr std::size_t kInboxBytes = 64 << 20;
constexpr std::size_t kOutboxBytes = 32 << 20;
constexpr std::size_t kBacklog = 1024;  // requests that wait for another instance, or for the executor

std::optional<Signer> signer_of(const Network& network) {
  if (network.security.empty()) return std::nullopt;
  return Signer(network.security);
}

}  // namespace

Service::Service(const ServiceConfig& config, Companion companion)
    : config_(config),
      companion_(std::move(companion)),
      robot_(load_parameters(config.robot)),
      robot_hash_(robot_hash(robot_)),
      signer_(signer_of(config.network)),
      port_(dds::guarded_participant(config.network)),
      ownership_(config.instance, config.robot_id),
      executor_(config.robot_id, robot_hash_),
      backlog_(kBacklog),
      inbox_(kInboxBytes),
      settled_at_(Clock::now() + kSettle),
      queue_(config.queue),
      cache_(kRemembered, kRememberedBytes),
      refused_lately_(kRefusedLately, kRelaysEnd),
      unclaimed_(kUnclaimedOfOne, kUnclaimedBytes),
      outbox_([this](const SharedReply& reply) { return send(reply); }, kOutboxBytes),
      solvers_(
          config.workers, worker_settings(config), [this] { port_.wake(); }, companion_.turns()) {
  if (config.joint_trajectory) ros_.emplace(port_.participant(), robot_, config.joint_names);
  if (config.remember.empty()) return;
  store_.emplace(config.remember, config.robot_id, [this] { port_.wake(); });
  for (const SharedReply& reply : store_->take_earlier()) remember(reply);
}

void Service::stop() {
  stopping_ = true;
  port_.wake();
}

void Service::run() {
  while (!stopping_) {
    if (Clock::now() >= next_heartbeat_) heartbeat();
    listen_to_others();
    meet_clients();
    outbox_.deliver();
    if (settled()) {
      release_stored();
      for (const auto& wanted : port_.take_cancels()) cancel(wanted);
      take_in();
      relay();
      work();
      port_.wait(time_to_next());
    } else {
      std::this_thread::sleep_for(kGlance);  // requests stay where they are, and would end every wait
    }
  }
  end();
}

bool Service::settled() const {
  const auto now = Clock::now();
  return now >= settled_at_ && now - last_heartbeat_ <= kLease;
}

std::chrono::nanoseconds Service::time_to_next() const {
  const auto now = Clock::now();
  if (!inbox_.empty() || answering_) return {};
  Clock::time_point next = std::min(next_heartbeat_, outbox_.next());
  if (!ownership_.alone()) next = std::min(next, backlog_.next_relay());
  for (const Job& job : queue_.jobs()) {
    next = std::min(next, job.deadline);
    if (job.awaited) next = std::min(next, now + kAnswerSoon);
    if (executes(job.order) && !presence_.may_start(job.order, now)) next = std::min(next, now + kAnswerSoon);
  }
  for (const Job* job : solvers_.jobs()) next = std::min(next, job->deadline);
  return std::max(Clock::duration::zero(), next - now);
}

void Service::heartbeat() {
  const auto now = Clock::now();
  if (now - last_heartbeat_ > kLease) {
    // Other instances have concluded that this one has ended, and one of them may lead by now. It must not act before
    // it has heard who leads, and what the executor is doing.
    spdlog::warn("absent for {:.2f} s", seconds(now - last_heartbeat_));
    settled_at_ = now + kSettle;
    waited_ = true;
  }
  last_heartbeat_ = now;
  next_heartbeat_ = now + kHeartbeat;
  solvers_.replace_missing();
  port_.look_for_senders();
  look_after_clients();
  unclaimed_.forget_older_than(kUnclaimedFor);
  backlog_.forget_if([&](const Backlog::Entry& entry) {  // of its budget nothing has been checked yet
    const double budget = entry.order.budget;
    return now - entry.arrived > duration_of(budget > 0 && budget <= config_.longest_budget ? budget : config_.budget);
  });
  const ServiceStatus now_so = status();
  port_.send(now_so);
  publish_metrics(now_so);
  companion_.tell_alive();
}

void Service::publish_metrics(const ServiceStatus& status) {
  if (!companion_.has_metrics()) return;
  Metrics metrics;
  metrics.status = status;
  metrics.tally = tally_;
  metrics.executor = executor_.latest();
  metrics.remembered = cache_.size();
  companion_.publish(std::move(metrics));
}

ServiceStatus Service::status() const {
  ServiceStatus status = tally_.status();
  status.instance = config_.instance;
  status.robot_id = config_.robot_id;
  status.robot_hash = robot_hash_;
  status.version = program_version();
  status.epoch = ownership_.epoch();
  status.uptime = seconds(Clock::now() - began_);
  status.queued = static_cast<std::uint32_t>(queue_.size());
  status.queue_capacity = static_cast<std::uint32_t>(queue_.capacity());
  status.workers = static_cast<std::uint32_t>(solvers_.size());
  status.workers_lost = static_cast<std::uint32_t>(solvers_.lost());
  status.solving = static_cast<std::uint32_t>(solvers_.jobs().size());
  status.memory = resident_bytes(::getpid()) + solvers_.memory();
  return status;
}

}  // namespace fjr
