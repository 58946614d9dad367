// Requests that have arrived and were not processed yet. They are taken from the participants in turn, so that one who
// sends many does not make others wait. The size in bytes is bounded; when full, the latest request of the participant
// whose requests take the most is dropped, and its client sends it again.
#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "planner/protocol/messages.h"

namespace fjr {

class Inbox {
 public:
  explicit Inbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  void add(Order order) {
    Waiting& waiting = waiting_[order.origin];
    waiting.bytes += size_of(order);
    bytes_ += size_of(order);
    waiting.orders.push_back(std::move(order));
    while (bytes_ > most_bytes_) drop_one();
  }

  std::optional<Order> next() {
    if (waiting_.empty()) return std::nullopt;
    auto turn = waiting_.upper_bound(last_);
    if (turn == waiting_.end()) turn = waiting_.begin();
    last_ = turn->first;
    Order order = std::move(turn->second.orders.front());
    turn->second.orders.pop_front();
    count_off(turn, order);
    return order;
  }

  bool empty() const { return waiting_.empty(); }

 private:
  struct Waiting {  // of a participant
    std::deque<Order> orders;
    std::size_t bytes = 0;
  };
  using ByParticipant = std::map<Origin, Waiting>;

  void drop_one() {
    const auto most = std::max_element(waiting_.begin(), waiting_.end(),
                                       [](const auto& a, const auto& b) { return a.second.bytes < b.second.bytes; });
    const Order dropped = std::move(most->second.orders.back());
    most->second.orders.pop_back();
    count_off(most, dropped);
  }

  void count_off(ByParticipant::iterator participant, const Order& removed) {
    bytes_ -= size_of(removed);
    participant->second.bytes -= size_of(removed);
    if (participant->second.orders.empty()) waiting_.erase(participant);
  }

  const std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  ByParticipant waiting_;
  Origin last_{};  // whose turn it was
};

}  // namespace fjr
