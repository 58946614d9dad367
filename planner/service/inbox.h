// Requests that have arrived and were not processed yet. They are taken from the participants in turn, so that one who
// sends many does not make others wait. The size in bytes is bounded; when full, the latest request of the participant
// with the most requests is dropped, and its client sends it again.
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
