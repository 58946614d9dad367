// Liveness of clients.
#include <set>

#include "planner/service/service.h"

namespace fjr {

// Records a sign of life. The middleware of a client with a reader acknowledges replies; for a client without a reader
// only the liveliness in DDS can be used.
void Service::listen_for(const Order& order) {
  if (const auto told = port_.clients().acknowledged(order.id)) return presence_.heard(order.id, *told);
  if (!port_.clients().listens(order.id) && port_.present(order.origin)) presence_.heard(order.id, Clock::now());
}

bool Service::may_start(const Order& order) {
  if (!presence_.may_start(order, Clock::now())) listen_for(order);
  return presence_.may_start(order, Clock::now());
}

// Asks a client for a sign of life by repeating that its request is accepted, which the client acknowledges.
void Service::ask(const Order& order) {
  presence_.asked(order.id, Clock::now());
  if (port_.clients().listens(order.id)) {
    post(std::make_shared<const Reply>(reply_to(order, ReplyState::kAccepted)));
  }
}

void Service::look_after_clients() {
  const auto now = Clock::now();
  std::set<decltype(RequestId::client)> waiting;
  for (const Order* order : orders_in_hand()) {
    listen_for(*order);
    if (presence_.is_due(*order, now)) ask(*order);
    waiting.insert(order->id.client);
  }
  for (const Answer& answer : being_stored_) waiting.insert(answer.reply->id.client);
  presence_.keep_if([&](const auto& client) { return waiting.contains(client); });
  const auto gone = [&](const Job& job) { return presence_.gone(job.order, now); };
  while (const auto job = queue_.remove_if(gone))
    finish(*job, reply_to(job->order, ReplyState::kCancelled, client_gone()));
  while (const auto job = solvers_.stop_if(gone))
    finish(*job, reply_to(job->order, ReplyState::kCancelled, client_gone()));
}

void Service::meet_clients() {
  if (!port_.clients().look()) return;
  const auto listens = [this](const RequestId& id) { return port_.clients().listens(id); };
  for (SharedReply& reply : unclaimed_.claim(listens)) post(std::move(reply));
}

}  // namespace fjr
