// Requests that another instance is to answer, kept in case it will not. Bounded; the oldest go first.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <utility>

#include "planner/service/messages.h"

namespace fjr {

class Backlog {
 public:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    Order order;
    Clock::time_point arrived;
    bool cancelled = false;
  };

  explicit Backlog(std::size_t most) : most_(most) {}

  void add(Order order, Clock::time_point arrived) {
    if (find(order.id) != entries_.end()) return;
    if (entries_.size() >= most_) entries_.pop_front();
    entries_.push_back({std::move(order), arrived, false});
  }
  void cancel(const RequestId& id) {
    if (const auto found = find(id); found != entries_.end()) found->cancelled = true;
  }
  void answered(const RequestId& id) {
    if (const auto found = find(id); found != entries_.end()) entries_.erase(found);
  }
  // What nobody waits for any more.
  template <class Overdue>
  void forget_if(Overdue&& overdue) {
    std::erase_if(entries_, overdue);
  }
  std::deque<Entry> take() { return std::exchange(entries_, {}); }
  std::size_t size() const { return entries_.size(); }

 private:
  std::deque<Entry>::iterator find(const RequestId& id) {
    return std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.order.id == id; });
  }

  std::size_t most_;
  std::deque<Entry> entries_;  // of arrival
};

}  // namespace fjr
