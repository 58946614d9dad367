// The ids of recently answered requests. The number is bounded; when full, the oldest of the participant with the most
// ids is forgotten.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <iterator>
#include <map>
#include <utility>

#include "planner/protocol/messages.h"

namespace fjr {

class RecentIds {
 public:
  using Clock = std::chrono::steady_clock;

  RecentIds(std::size_t most, Clock::duration lifetime) : most_(most), lifetime_(lifetime) {}

  void add(const RequestId& id, const Origin& participant, Clock::time_point now) {
    for (auto of_one = ids_.begin(); of_one != ids_.end();) {
      std::deque<Known>& known = of_one->second;
      while (!known.empty() && now - known.front().first > lifetime_) forget_oldest(known);
      of_one = known.empty() ? ids_.erase(of_one) : std::next(of_one);
    }
    ids_[participant].emplace_back(now, id);
    if (++size_ > most_) forget_oldest(std::max_element(ids_.begin(), ids_.end(), has_less)->second);
  }
  bool contains(const RequestId& id, Clock::time_point now) const {
    const auto is_it = [&](const Known& known) { return known.second == id && now - known.first <= lifetime_; };
    return std::any_of(ids_.begin(), ids_.end(),
                       [&](const auto& of_one) { return std::ranges::any_of(of_one.second, is_it); });
  }

 private:
  using Known = std::pair<Clock::time_point, RequestId>;
  using OfAll = std::map<Origin, std::deque<Known>>;

  static bool has_less(const OfAll::value_type& a, const OfAll::value_type& b) {
    return a.second.size() < b.second.size();
  }
  void forget_oldest(std::deque<Known>& known) {
    known.pop_front();
    --size_;
  }

  std::size_t most_;
  Clock::duration lifetime_;
  std::size_t size_ = 0;
  OfAll ids_;  // of arrival
};

}  // namespace fjr
