#include "planner/service/worker_host.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "common/input_error.h"
#include "model/parameters.h"
#include "planner/service/lease_table.h"
#include "planner/service/version.h"
#include "planner/service/watchdog.h"

namespace fjr {
namespace {

constexpr std::chrono::milliseconds kOfferPause{150};
constexpr std::chrono::seconds kSayAgain{1};  // a result that nobody has taken
constexpr std::chrono::milliseconds kLeave{200};

// Returns the id of a job here, which is that of its lease. A request may have two leases for a moment, from an earlier
// and a later owner.
RequestId job_id(const LeaseId& lease) { return {lease.owner, lease.number}; }

Job job_of(LeaseWord word) {
  Job job;
  job.order.id = job_id(word.lease);
  job.order.name = std::move(word.name);
  job.order.action = word.executes ? Action::kPlanAndExecute : Action::kPlan;
  job.document = std::move(word.document);
  if (word.rows.empty()) return job;
  Reply planned;
  planned.state = ReplyState::kSolved;
  planned.rows = std::move(word.rows);
  job.planned = std::make_shared<const Reply>(std::move(planned));
  return job;
}

}  // namespace

WorkerHost::WorkerHost(const ServiceConfig& config, Companion companion)
    : config_(config),
      companion_(std::move(companion)),
      robot_hash_(robot_hash(load_parameters(config.robot))),
      worker_(new_client().client),
      port_(dds::guarded_participant(config.network), worker_),
      solvers_(
          config.workers, worker_settings(config), [this] { port_.wake(); }, companion_.turns()) {}

void WorkerHost::stop() {
  stopping_ = true;
  port_.wake();
}

void WorkerHost::run() {
  spdlog::info("offering slots={} instance={} domain={} robot_id={} robot={}", solvers_.size(), config_.instance,
               config_.network.domain, config_.robot_id, robot_hash_.substr(0, 12));
  companion_.tell_ready();
  while (!stopping_) {
    if (Clock::now() >= next_heartbeat_) heartbeat();
    for (LeaseWord& word : port_.take_leases()) receive(std::move(word));
    take_news();
    give_work();
    say_results();
    port_.wait(std::max(Clock::duration::zero(), next_heartbeat_ - Clock::now()));
  }
  end();
}

void WorkerHost::heartbeat() {
  next_heartbeat_ = Clock::now() + kOfferPause;
  solvers_.replace_missing();
  return_what_cannot_be_solved();
  look_for_owners();
  send_offer();
  companion_.tell_alive();
}

void WorkerHost::send_offer() {
  WorkerOffer offer;
  offer.worker = worker_;
  offer.instance = config_.instance;
  offer.robot_id = config_.robot_id;
  offer.robot_hash = robot_hash_;
  offer.version = program_version();
  offer.slots = static_cast<std::uint32_t>(solvers_.size());
  for (const auto& [lease, held] : held_) offer.held.push_back({lease, held.progress});
  port_.send(offer);
}

// Gives up the leases of owners that are gone or were restarted.
void WorkerHost::look_for_owners() {
  const auto now = Clock::now();
  for (const auto& [instance, process] : port_.take_heard()) {
    const auto [known, is_new] = owners_.try_emplace(instance);
    if (!is_new && known->second.process != process && known->second.process != 0) drop_if_owned_by(instance);
    known->second = {process, now};
  }
  std::erase_if(owners_, [&](const auto& owner) {
    if (now - owner.second.heard <= kLeaseTime) return false;
    drop_if_owned_by(owner.first);
    return true;
  });
}

void WorkerHost::drop_if_owned_by(const std::string& instance) {
  std::vector<LeaseId> over;
  for (const auto& [lease, held] : held_) {
    if (held.instance == instance) over.push_back(lease);
  }
  if (!over.empty()) spdlog::warn("owner gone instance={} leases given up: {}", instance, over.size());
  for (const LeaseId& lease : over) drop(lease);
}

void WorkerHost::receive(LeaseWord word) {
  switch (word.kind) {
    case LeaseKind::kGranted:
      return begin(std::move(word));
    case LeaseKind::kOver:
      return drop(word.lease);
    case LeaseKind::kRefused:
      return refused(word);
  }
}

// Begins a lease. An owner that was not heard before is added.
void WorkerHost::begin(LeaseWord word) {
  owners_.try_emplace(word.instance, Owner{0, Clock::now()});
  if (held_.contains(word.lease) || held_.size() >= kMaxHeld) return;
  Held& held = held_[word.lease];
  held.instance = word.instance;
  if (waiting_.size() >=
      solvers_.without_job()) {  // another owner's lease took the slot, or its process has just ended
    return conclude(job_id(word.lease), {});
  }
  if (log_.allows()) spdlog::info("leased by={} id={} name={}", word.instance, text(word.id), word.name);
  refused_.clear();
  waiting_.push_back(job_of(std::move(word)));
  give_work();
}

void WorkerHost::give_work() {
  while (!waiting_.empty() && solvers_.may_solve()) {
    solvers_.solve(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  if (waiting_.empty()) solvers_.withdraw();
}

// Returns waiting leases for which there is no process any more, because one has ended.
void WorkerHost::return_what_cannot_be_solved() {
  while (waiting_.size() > solvers_.without_job()) {
    conclude(waiting_.back().order.id, {});
    waiting_.pop_back();
  }
}

void WorkerHost::drop(const LeaseId& lease) {
  held_.erase(lease);
  std::erase_if(waiting_, [&](const Job& job) { return job.order.id == job_id(lease); });
  (void)solvers_.stop_if([&](const Job& job) { return job.order.id == job_id(lease); });
}

// Handles a refused lease. A different version is normal during an upgrade; a different robot file is a mistake.
void WorkerHost::refused(const LeaseWord& word) {
  if (word.refused == RefusedFor::kRobot) {
    throw InputError(config_.robot.string(), "",
                     word.sentence + ": give both the same file, or this worker a robot_id of its own");
  }
  if (std::exchange(refused_, word.sentence) == word.sentence) return;
  spdlog::warn("no leases for this worker: {}", word.sentence);
}

void WorkerHost::take_news() {
  Solvers::News news = solvers_.take_news();
  for (const ProgressReport& report : news.progress) {
    for (auto& [lease, held] : held_) {
      if (job_id(lease) == report.id) held.progress = report.progress;
    }
  }
  for (const Job& job : news.lost) {
    WorkResult result;
    result.outcome = WorkOutcome::kLost;
    conclude(job.order.id, std::move(result));
  }
  for (SolveOutcome& outcome : news.outcomes) {
    WorkResult result;
    result.outcome = WorkOutcome::kDone;
    result.state = outcome.state;
    result.why = std::move(outcome.why);
    result.errors = outcome.errors;
    result.plan_json = std::move(outcome.plan_json);
    result.rows = std::move(outcome.rows);
    result.stops = std::move(outcome.stops);
    conclude(outcome.job.order.id, std::move(result));
  }
}

void WorkerHost::conclude(const RequestId& id, WorkResult result) {
  for (auto& [lease, held] : held_) {
    if (job_id(lease) != id) continue;
    result.lease = lease;
    result.worker = worker_;
    held.result = std::move(result);
    held.say_at = Clock::now();
    return;
  }
}

void WorkerHost::say_results() {
  const auto now = Clock::now();
  for (auto& [lease, held] : held_) {
    if (!held.result || held.say_at > now) continue;
    held.say_at = now + (port_.send(*held.result) ? std::chrono::milliseconds(kSayAgain) : kOfferPause);
  }
}

void WorkerHost::end() {
  tell_stopping();
  std::size_t returned = 0;
  for (auto& [lease, held] : held_) {
    if (held.result) continue;
    conclude(job_id(lease), {});
    ++returned;
  }
  say_results();
  port_.flush(kLeave);
  spdlog::info("stopped returned={}", returned);
}

}  // namespace fjr
