// Replies to clients that do not listen yet: they come late, or never. Bounded for each participant, whatever ids it
// uses, and in all; the oldest go first, and those of whoever has most.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "planner/service/messages.h"

namespace fjr {

class Unclaimed {
 public:
  using Clock = std::chrono::steady_clock;

  Unclaimed(std::size_t most_of_one, std::size_t most_bytes) : most_of_one_(most_of_one), most_bytes_(most_bytes) {}

  void keep(SharedReply reply) {
    std::deque<Kept>& of_one = kept_[reply->origin];
    bytes_ += size_of(*reply);
    of_one.push_back({std::move(reply), Clock::now()});
    if (of_one.size() > most_of_one_) drop_oldest(of_one);
    while (bytes_ > most_bytes_) drop_oldest(furthest());
  }

  // Takes what is for clients of which `listens` holds, in order.
  template <class Listens>
  std::vector<SharedReply> claim(Listens&& listens) {
    std::vector<SharedReply> claimed;
    for (auto& [origin, of_one] : kept_) {
      std::erase_if(of_one, [&](Kept& kept) {
        if (!listens(kept.reply->id)) return false;
        bytes_ -= size_of(*kept.reply);
        claimed.push_back(std::move(kept.reply));
        return true;
      });
    }
    return claimed;
  }

  void forget_older_than(Clock::duration age) {
    const auto now = Clock::now();
    for (auto of_one = kept_.begin(); of_one != kept_.end();) {
      while (!of_one->second.empty() && now - of_one->second.front().since > age) drop_oldest(of_one->second);
      of_one = of_one->second.empty() ? kept_.erase(of_one) : std::next(of_one);
    }
  }

  std::size_t bytes() const { return bytes_; }

 private:
  struct Kept {
    SharedReply reply;
    Clock::time_point since;
  };

  void drop_oldest(std::deque<Kept>& of_one) {
    bytes_ -= size_of(*of_one.front().reply);
    of_one.pop_front();
  }
  std::deque<Kept>& furthest() {
    return std::max_element(kept_.begin(), kept_.end(),
                            [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); })
        ->second;
  }

  const std::size_t most_of_one_, most_bytes_;
  std::size_t bytes_ = 0;
  std::map<Origin, std::deque<Kept>> kept_;
};

}  // namespace fjr
