// Requests that have arrived and were not looked at yet: one of each participant in turn, so that whoever sends many
// makes nobody else wait. Bounded in bytes; of whoever has most the latest is dropped, which its client sends again.
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
    bytes_ += size_of(order);
    waiting_[order.origin].push_back(std::move(order));
    while (bytes_ > most_bytes_) drop_one();
  }

  std::optional<Order> next() {
    if (waiting_.empty()) return std::nullopt;
    auto turn = waiting_.upper_bound(last_);
    if (turn == waiting_.end()) turn = waiting_.begin();
    last_ = turn->first;
    Order order = std::move(turn->second.front());
    turn->second.pop_front();
    bytes_ -= size_of(order);
    if (turn->second.empty()) waiting_.erase(turn);
    return order;
  }

  bool empty() const { return waiting_.empty(); }

 private:
  void drop_one() {
    const auto most = std::max_element(waiting_.begin(), waiting_.end(),
                                       [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    bytes_ -= size_of(most->second.back());
    most->second.pop_back();
    if (most->second.empty()) waiting_.erase(most);
  }

  const std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::map<Origin, std::deque<Order>> waiting_;
  Origin last_{};  // whose turn it was
};

}  // namespace fjr
