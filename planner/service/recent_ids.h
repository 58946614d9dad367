// The ids of requests that were answered a moment ago: bounded, the oldest are forgotten first.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <utility>

#include "planner/protocol/messages.h"

namespace fjr {

class RecentIds {
 public:
  using Clock = std::chrono::steady_clock;

  RecentIds(std::size_t most, Clock::duration lifetime) : most_(most), lifetime_(lifetime) {}

  void add(const RequestId& id, Clock::time_point now) {
    ids_.emplace_back(now, id);
    while (ids_.size() > most_ || now - ids_.front().first > lifetime_) ids_.pop_front();
  }
  bool contains(const RequestId& id, Clock::time_point now) const {
    return std::any_of(ids_.begin(), ids_.end(),
                       [&](const auto& known) { return known.second == id && now - known.first <= lifetime_; });
  }

 private:
  std::size_t most_;
  Clock::duration lifetime_;
  std::deque<std::pair<Clock::time_point, RequestId>> ids_;
};

}  // namespace fjr
