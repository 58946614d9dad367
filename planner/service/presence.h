// Tracks which clients are still alive, by what they send and acknowledge. An arm must not start to move for a client
// that is gone, and its requests need not be solved.
#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include "planner/protocol/messages.h"
#include "planner/service/admission.h"

namespace fjr {

// [s] Least start_within that a request may ask for. A live client is heard of with every second heartbeat, 0.3 s, at
// the latest, so that a shorter one would refuse live clients.
inline constexpr double kLeastStartWithin = 0.5;

inline Refusal client_gone() {
  return {Reason::kClientGone, "",
          "its client gave no sign of life for longer than it may start within; send it again"};
}

class Presence {
 public:
  using Clock = std::chrono::steady_clock;

  void heard(const RequestId& id, Clock::time_point when) {
    Client& client = clients_[id.client];
    client.heard = std::max(client.heard, when);
    if (client.asked && client.heard >= *client.asked) client.asked.reset();
  }
  Clock::time_point last_heard(const RequestId& id) const {
    const auto found = clients_.find(id.client);
    return found == clients_.end() ? Clock::time_point{} : found->second.heard;
  }

  // Returns whether the client must be asked for a sign of life. asked() records that it has been.
  bool is_due(const Order& order, Clock::time_point now) const {
    const auto found = clients_.find(order.id.client);
    return found != clients_.end() && !found->second.asked && now - found->second.heard > asks_after(order);
  }
  void asked(const RequestId& id, Clock::time_point now) { clients_[id.client].asked = now; }

  // Returns whether the client was heard recently enough for the request to start the arm now.
  bool may_start(const Order& order, Clock::time_point now) const {
    return now - last_heard(order.id) <= allowed_silence(order);
  }

  // Returns whether the client was asked, has had time to answer, and was not heard for too long. A client that was
  // never heard, as after the death of an owner, may not have discovered this instance yet, so it gets as much time to
  // answer as others.
  bool gone(const Order& order, Clock::time_point now) const {
    const auto found = clients_.find(order.id.client);
    if (found == clients_.end() || !found->second.asked) return false;
    const auto to_answer = std::clamp<Clock::duration>(allowed_silence(order) - asks_after(order), kToAnswer, kToPlan);
    return now - *found->second.asked > to_answer && now - found->second.heard > allowed_silence(order);
  }

  template <class Wanted>
  void keep_if(Wanted&& wanted) {
    std::erase_if(clients_, [&](const auto& client) { return !wanted(client.first); });
  }

 private:
  static constexpr std::chrono::seconds kToAnswer{1};
  static constexpr std::chrono::seconds kToStart{2};  // by default
  static constexpr std::chrono::seconds kToPlan{5};   // nothing moves meanwhile

  struct Client {
    Clock::time_point heard{};
    std::optional<Clock::time_point> asked;  // without an answer since
  };

  static Clock::duration asks_after(const Order& order) { return allowed_silence(order) / 4; }
  static Clock::duration allowed_silence(const Order& order) {
    if (!executes(order)) return kToPlan;
    if (order.start_within <= 0) return kToStart;
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(order.start_within));
  }

  std::map<decltype(RequestId::client), Client> clients_;
};

}  // namespace fjr
