// Repetitions of motions, which learn from the last run.
#include <fmt/format.h>

#include <utility>
#include <variant>

#include "planner/results/repetition_json.h"
#include "planner/service/service.h"

namespace fjr {
namespace {

constexpr std::chrono::seconds kOnItsWay{1};  // wait for the run, which the executor publishes before the result

}  // namespace

// Returns the id of the plan that a trajectory repeats. It is the id itself if the trajectory is that plan, or if it is
// no longer known.
RequestId Service::motion_of(const RequestId& trajectory_id) const {
  const SharedReply reply = cache_.find(trajectory_id);
  return reply ? reply->motion : trajectory_id;
}

bool Service::is_run_of(const RequestId& motion, const RequestId& trajectory_id) const {
  return cache_.find(trajectory_id) && motion_of(trajectory_id) == motion;
}

// Returns the trajectory that moved the arm last, if its run has not arrived yet. The client may have been quicker than
// the run, or this service has just started and receives earlier runs first.
std::optional<RequestId> Service::run_on_its_way() const {
  const auto executor = executor_.latest();
  if (!executor || runs_.contains(executor->trajectory_id)) return std::nullopt;
  return cache_.find(executor->trajectory_id) ? std::optional(executor->trajectory_id) : std::nullopt;
}

bool Service::has_its_run(const Job& job) const {
  return !job.awaited || runs_.contains(*job.awaited) || Clock::now() - job.awaited_since > kOnItsWay;
}

void Service::repeat_motion(const Order& order, Clock::time_point arrived) {
  const auto not_at_rest = [&](const std::string& why) { reject(order, {Reason::kArmNotAtRest, "", why}); };
  if (config_.workers == 0) {
    return reject(order, {Reason::kUnsupported, "action",
                          "repetitions are found by the service's own workers, and this one has none"});
  }
  if (motion_pending()) return not_at_rest("an earlier request has not moved the arm yet");
  const auto rest = executor_.rest();
  if (const auto* why = std::get_if<std::string>(&rest)) return not_at_rest(*why);
  Job job;
  job.order = order;
  job.rest_to_rest = true;
  job.awaited = run_on_its_way();
  job.awaited_since = Clock::now();
  if (!job.awaited) {
    if (auto refusal = choose_run(job)) return reject(order, std::move(*refusal));
  }
  enqueue(std::move(job), arrived);
}

// Chooses the last run from which the next repetition learns. Without a known run, the motion is executed as planned.
std::optional<Refusal> Service::choose_run(Job& job) const {
  const RequestId motion = motion_of(job.order.trajectory_id);
  job.awaited.reset();
  job.run = runs_.last([&](const RequestId& id) { return is_run_of(motion, id); });
  const RequestId& executed = job.run ? job.run->trajectory_id : job.order.trajectory_id;
  job.planned = cache_.find(executed);
  if (auto refusal = refusal_of_execution(executed, job.planned, in_hand(executed), robot_hash_)) return refusal;
  job.request_hash = job.planned->request_hash;
  if (!job.run) return std::nullopt;
  if (auto refusal = refusal_of_learnt()) return refusal;
  job.refused_fraction = refused_repetitions_.of(to_text(executed));
  if (job.run->code == ResultCode::kSuccessful) return std::nullopt;
  return Refusal{Reason::kNoTrajectory, "trajectory_id",
                 fmt::format("its last run, {}, ended as {}: {}; have the plan, or a run before it, executed, and "
                             "learning goes on from there",
                             text(executed), name(job.run->code), job.run->sentence)};
}

// Returns a refusal if the present executor does not accept learnt motions. It is temporary, since another executor may
// be started.
std::optional<Refusal> Service::refusal_of_learnt() const {
  if (port_.learnt_are_taken(executor_.source())) return std::nullopt;
  return Refusal{
      Reason::kNoTrajectory, "trajectory_id",
      "the executor takes no motions that were learnt: it is of an earlier version, or credentials, its own or "
      "the service's, do not permit fjr/learnt_trajectory"};
}

void Service::hear(const ExecutionResult& result) {
  executor_.concluded(result.trajectory_id);
  if (result.code != ResultCode::kRepetitionRefused) return;
  const SharedReply refused = cache_.find(result.trajectory_id);
  if (const auto taken = refused ? correction_in(refused->plan_json) : std::nullopt) {
    refused_repetitions_.add(taken->run, taken->fraction);
  }
}

void Service::hear(ExecutedRun run) {
  if (run.robot_id == config_.robot_id && run.robot_hash == robot_hash_) runs_.add(std::move(run));
}

}  // namespace fjr
