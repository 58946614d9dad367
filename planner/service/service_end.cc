// The end of a service: pending requests go to the standby, or are refused so that their clients can send them again.
#include <spdlog/spdlog.h>

#include <utility>

#include "planner/service/durations.h"
#include "planner/service/service.h"
#include "planner/service/watchdog.h"

namespace fjr {
namespace {

constexpr std::chrono::milliseconds kFarewell{400};  // for clients to take their last replies
constexpr std::size_t kRelayedAtOnce = 128;

}  // namespace

// Ends the service. If there is a standby, it takes over the requests, and clients need not send them again.
void Service::end() {
  tell_stopping();
  take_last_cancels();
  await_stored(Clock::now() + kFarewell);
  const bool handing_over = ownership_.has_standby();
  const auto farewell = [this](const Job& job) {
    give_up(job, ReplyState::kCancelled, Reason::kShuttingDown, "the service is shutting down; send the request again");
  };
  if (handing_over) {
    hand_over();
  } else {
    for (const Job* job : solvers_.jobs()) farewell(*job);
    while (!queue_.empty()) farewell(queue_.pop());
    for (const Backlog::Entry& last : last_requests()) refuse_at_end(last);
  }
  const std::size_t in_hand = orders_in_hand().size();
  solvers_.disown();
  const auto over = Clock::now() + kFarewell;
  await_stored(over);
  for (outbox_.deliver(); !outbox_.empty() && Clock::now() < over; outbox_.deliver()) {
    port_.wait(std::chrono::milliseconds(1));
  }
  port_.clients().flush(over - Clock::now());
  spdlog::info("stopped handed_over={}", handing_over ? in_hand : 0);
}

// Hands the requests over to the standby, which has heard most of them already. The DDS writer keeps only the last 256
// samples for slow readers, so fewer than that are sent at a time, as long as there is time to wait.
void Service::hand_over() {
  const auto now = Clock::now(), over = now + kFarewell;
  const auto await_taken = [&] { port_.flush_relayed(std::max(Clock::duration::zero(), over - Clock::now())); };
  std::size_t count = 0;
  const auto relay = [&](const dds::Relayed& relayed) {
    port_.relay(relayed);
    if (++count % kRelayedAtOnce == 0) await_taken();
  };
  for (const Order* order : orders_in_hand()) {
    relay({*order, seconds(now - presence_.last_heard(order->id)), false});
  }
  for (const Backlog::Entry& last : last_requests()) {
    if (!cache_.find(last.order.id)) relay({last.order, 0, last.cancelled});
  }
  await_taken();
}

// Processes the cancellations that have arrived, so that the standby is not told to carry out cancelled requests.
void Service::take_last_cancels() {
  (void)fill_inbox(kFarewell);  // however many more keep coming
  const auto over = Clock::now() + kFarewell;
  for (auto cancels = port_.take_cancels(); !cancels.empty() && Clock::now() < over; cancels = port_.take_cancels()) {
    for (const auto& wanted : cancels) cancel(wanted);
  }
}

void Service::refuse_at_end(const Backlog::Entry& last) {
  if (!ownership_.answers_for(last.order.robot_id)) return;
  if (last.cancelled) return conclude(last);
  if (const SharedReply answered = cache_.find(last.order.id)) return post(answered);
  reject(last.order, {Reason::kShuttingDown, "", "the service is shutting down; send the request again"});
}

// Returns the requests that have not been answered and, after a take-over, those cancelled meanwhile.
std::vector<Backlog::Entry> Service::last_requests() {
  const auto ours = [this](const Backlog::Entry& entry) {
    return entry.asked ? ownership_.answers_for(entry.order.robot_id) : answers(entry);
  };
  std::vector<Backlog::Entry> last = backlog_.take_if(ours);
  while (auto order = inbox_.next()) last.push_back({.order = std::move(*order)});
  return last;
}

}  // namespace fjr
