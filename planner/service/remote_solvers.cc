#include "planner/service/remote_solvers.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <iterator>

#include "planner/service/admission.h"
#include "planner/service/version.h"

namespace fjr {
namespace {

void append(std::vector<Job>& to, std::vector<Job> from) {
  to.insert(to.end(), std::move_iterator(from.begin()), std::move_iterator(from.end()));
}

}  // namespace

RemoteSolvers::RemoteSolvers(const dds::Participant& participant, dds::Waitset& waitset, Owner owner)
    : owner_(std::move(owner)), port_(participant, waitset), leases_(new_client().client) {}

std::optional<LeaseTable::Choice> RemoteSolvers::choice() const {
  return leases_.least_loaded([this](const WorkerId& worker) { return port_.reachable(worker); });
}

std::optional<double> RemoteSolvers::load() const {
  const auto least = choice();
  return least ? std::optional(least->load) : std::nullopt;
}

LeaseWord RemoteSolvers::word(const LeaseId& lease, LeaseKind kind) const {
  LeaseWord word;
  word.lease = lease;
  word.kind = kind;
  word.instance = owner_.instance;
  return word;
}

std::optional<Job> RemoteSolvers::solve(Job job) {
  const auto to = choice();
  if (!to) return job;
  job.started = Job::Clock::now();
  LeaseWord granted = word({}, LeaseKind::kGranted);
  granted.id = job.order.id;
  granted.name = job.order.name;
  granted.executes = executes(job.order);
  granted.document = job.document;
  if (job.planned) granted.rows = job.planned->rows;
  granted.lease = leases_.grant(to->worker, std::move(job), Job::Clock::now());
  if (port_.send(to->worker, granted)) return std::nullopt;
  leases_.full(to->worker);
  return leases_.take(granted.lease, to->worker);
}

void RemoteSolvers::end(const WorkerId& worker, const LeaseId& lease) {
  (void)port_.send(worker, word(lease, LeaseKind::kOver));  // repeated for as long as the worker offers to go on
}

// Takes offers first, because they extend leases that would otherwise run out below.
Solvers::News RemoteSolvers::take_news() {
  Solvers::News news;
  for (const auto& [offer, alive] : port_.take_offers()) alive ? hear(offer, news) : lose(offer.worker, "gone", news);
  for (WorkResult& result : port_.take_results()) take(std::move(result), news);
  const auto now = Job::Clock::now();
  for (const WorkerId& worker : leases_.silent(now)) lose(worker, "silent", news);
  append(news.returned, leases_.expired(now));
  return news;
}

void RemoteSolvers::drop_news() {
  (void)port_.take_offers();
  (void)port_.take_results();
}

void RemoteSolvers::hear(const WorkerOffer& offer, Solvers::News& news) {
  if (offer.robot_id != owner_.robot_id) return;
  port_.meet(offer.worker);
  if (offer.robot_hash != owner_.robot_hash) {
    return refuse(offer, RefusedFor::kRobot,
                  fmt::format("robot_id {} is served by instance {} with another robot (hash {}, here {})",
                              owner_.robot_id, owner_.instance, owner_.robot_hash, offer.robot_hash));
  }
  if (offer.version != program_version()) {
    return refuse(offer, RefusedFor::kVersion,
                  fmt::format("instance {} is fjr {}, this worker is fjr {}: what it plans would not be the same",
                              owner_.instance, program_version(), offer.version));
  }
  if (names_.try_emplace(offer.worker, offer.instance).second) {
    spdlog::info("worker met name={} slots={}", offer.instance, offer.slots);
  }
  for (const LeaseId& over : leases_.heard(offer, Job::Clock::now())) end(offer.worker, over);
  report_progress(offer, news);
}

void RemoteSolvers::report_progress(const WorkerOffer& offer, Solvers::News& news) const {
  for (const HeldLease& held : offer.held) {
    const LeaseTable::Leased* leased = leases_.find(held.lease, offer.worker);
    if (leased == nullptr || held.progress.stage.empty()) continue;
    const std::chrono::duration<double> elapsed = Job::Clock::now() - leased->job.arrived;
    news.progress.push_back({leased->job.order.id, 0, held.progress, elapsed.count()});
  }
}

void RemoteSolvers::refuse(const WorkerOffer& offer, RefusedFor what, const std::string& sentence) {
  LeaseWord refusal = word({}, LeaseKind::kRefused);
  refusal.refused = what;
  refusal.sentence = sentence;
  (void)port_.send(offer.worker, refusal);  // said again with its next offer
  if (log_refused_.allows()) spdlog::warn("worker refused name={}: {}", offer.instance, sentence);
}

void RemoteSolvers::lose(const WorkerId& worker, const char* why, Solvers::News& news) {
  std::vector<Job> jobs = leases_.lost(worker);
  port_.forget(worker);
  const auto name = names_.extract(worker);
  if (name) spdlog::warn("worker {} name={} requests back in the queue: {}", why, name.mapped(), jobs.size());
  append(news.returned, std::move(jobs));
}

// The first result of a lease that is known is taken; others are ignored.
void RemoteSolvers::take(WorkResult result, Solvers::News& news) {
  auto job = leases_.take(result.lease, result.worker);
  end(result.worker, result.lease);
  if (!job) return;
  switch (result.outcome) {
    case WorkOutcome::kReturned:
      leases_.full(result.worker);
      return news.returned.push_back(std::move(*job));
    case WorkOutcome::kLost:
      ++lost_;
      ++job->lost;
      return news.lost.push_back(std::move(*job));
    case WorkOutcome::kDone:
      break;
  }
  SolveOutcome outcome;
  outcome.state = result.state;
  outcome.why = std::move(result.why);
  outcome.stops = std::move(result.stops);
  if (const SharedReply& planned = job->planned) {
    outcome.plan_json = planned->plan_json;
    outcome.errors = planned->errors;
    outcome.rows = planned->rows;
  } else {
    outcome.plan_json = std::move(result.plan_json);
    outcome.errors = result.errors;
    outcome.rows = std::move(result.rows);
  }
  outcome.job = std::move(*job);
  news.outcomes.push_back(std::move(outcome));
}

}  // namespace fjr
