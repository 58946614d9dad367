// Solving of requests, and their results.
#include <algorithm>
#include <utility>

#include "planner/service/service.h"

namespace fjr {

std::vector<const Order*> Service::orders_in_hand() const {
  std::vector<const Order*> orders;
  for (const Job* job : solvers_.jobs()) orders.push_back(&job->order);
  for (const Job& job : queue_.jobs()) orders.push_back(&job.order);
  return orders;
}

bool Service::in_hand(const RequestId& id) const {
  const auto orders = orders_in_hand();
  return std::any_of(orders.begin(), orders.end(), [&](const Order* order) { return order->id == id; });
}

bool Service::motion_pending() const {
  const auto orders = orders_in_hand();
  const auto moves = [](const Answer& answer) {
    return executes(answer.order) && answer.reply->state == ReplyState::kSolved;
  };
  return std::any_of(orders.begin(), orders.end(), [](const Order* order) { return executes(*order); }) ||
         std::any_of(being_stored_.begin(), being_stored_.end(), moves);
}

void Service::work() {
  Solvers::News news = solvers_.take_news();
  for (const ProgressReport& report : news.progress) port_.clients().send(report);
  for (Job& job : news.lost) {
    if (job.lost == 1) {
      queue_.push_front(std::move(job));
    } else {
      give_up(job, ReplyState::kFailed, Reason::kWorkerLost,
              "two solving processes ended unexpectedly while they solved it");
    }
  }
  for (Job& job : news.returned) queue_.push_front(std::move(job));
  for (SolveOutcome& outcome : news.outcomes) {
    const bool moves = executes(outcome.job.order) && outcome.state == ReplyState::kSolved;
    if (moves && !may_start(outcome.job.order)) {
      finish(outcome.job, reply_to(outcome.job.order, ReplyState::kCancelled, client_gone()));
      continue;
    }
    Reply reply = reply_to(outcome.job.order, outcome.state, std::move(outcome.why));
    reply.plan_json = std::move(outcome.plan_json);
    reply.errors = outcome.errors;
    reply.rows = std::move(outcome.rows);
    reply.stops = std::move(outcome.stops);
    finish(outcome.job, std::move(reply));
  }
  expire();
  give_work();
}

void Service::give_work() {
  const auto ready = [this](const Job& job) {
    return (!executes(job.order) || may_start(job.order)) && has_its_run(job);
  };
  const auto solvable = [&](const Job& job) { return ready(job) && (!solved_here(job) || solvers_.may_solve_here()); };
  while (solvers_.may_solve()) {
    auto job = queue_.pop_if(solvable);
    if (!job) break;
    if (auto refusal = job->awaited ? choose_run(*job) : std::nullopt) {
      finish(*job, reply_to(job->order, ReplyState::kFailed, std::move(*refusal)));
    } else if (auto untold = solvers_.solve(*std::move(job))) {
      queue_.push_front(std::move(*untold));
    }
  }
  if (!queue_.any_of(ready)) solvers_.withdraw();
}

void Service::expire() {
  const auto overdue = [now = Clock::now()](const Job& job) { return job.deadline <= now; };
  while (const auto job = queue_.remove_if(overdue)) {
    give_up(*job, ReplyState::kExpired, Reason::kBudget, "the time budget was used up while it waited");
  }
  while (const auto job = solvers_.stop_if(overdue)) {
    give_up(*job, ReplyState::kExpired, Reason::kBudget, "the time budget was used up while it was solved");
  }
}

}  // namespace fjr
