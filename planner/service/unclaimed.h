// Replies to clients whose reader is not known yet; it may be discovered late or never. Bounded are the number of
// clients of one participant, and the total size in bytes; the oldest replies of the participant with the most bytes
// are dropped first. The number of replies per client is not bounded, because requests can arrive well before the
// client's reader is known.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "planner/protocol/messages.h"

namespace fjr {

class Unclaimed {
 public:
  using Clock = std::chrono::steady_clock;

  // Keeps replies to at most so many clients of one participant, and at most so many bytes in all.
  Unclaimed(std::size_t most_clients_of_one, std::size_t most_bytes)
      : most_clients_of_one_(most_clients_of_one), most_bytes_(most_bytes) {}

  void keep(SharedReply reply) {
    OfOne& of_one = kept_[reply->origin];
    of_one.bytes += size_of(*reply);
    bytes_ += size_of(*reply);
    ++of_one.clients[reply->id.client];
    of_one.replies.push_back({std::move(reply), Clock::now()});
    while (of_one.clients.size() > most_clients_of_one_) drop_oldest(of_one);
    while (bytes_ > most_bytes_) drop_oldest(furthest());
  }

  // Removes and returns, in order, the replies to clients for which listens(id) is true.
  template <class Listens>
  std::vector<SharedReply> claim(Listens&& listens) {
    std::vector<SharedReply> claimed;
    for (auto& [origin, of_one] : kept_) {
      std::erase_if(of_one.replies, [&, &from = of_one](Kept& kept) {
        if (!listens(kept.reply->id)) return false;
        forget(from, *kept.reply);
        claimed.push_back(std::move(kept.reply));
        return true;
      });
    }
    return claimed;
  }

  void forget_older_than(Clock::duration age) {
    const auto now = Clock::now();
    for (auto of_one = kept_.begin(); of_one != kept_.end();) {
      std::deque<Kept>& replies = of_one->second.replies;
      while (!replies.empty() && now - replies.front().since > age) drop_oldest(of_one->second);
      of_one = replies.empty() ? kept_.erase(of_one) : std::next(of_one);
    }
  }

  std::size_t bytes() const { return bytes_; }

 private:
  struct Kept {
    SharedReply reply;
    Clock::time_point since;
  };

  struct OfOne {  // participant
    std::deque<Kept> replies;
    std::map<decltype(RequestId::client), std::size_t> clients;  // how many of the replies are for whom
    std::size_t bytes = 0;
  };

  void forget(OfOne& of_one, const Reply& reply) {
    bytes_ -= size_of(reply);
    of_one.bytes -= size_of(reply);
    const auto client = of_one.clients.find(reply.id.client);
    if (--client->second == 0) of_one.clients.erase(client);
  }
  void drop_oldest(OfOne& of_one) {
    forget(of_one, *of_one.replies.front().reply);
    of_one.replies.pop_front();
  }
  OfOne& furthest() {
    return std::max_element(kept_.begin(), kept_.end(),
                            [](const auto& a, const auto& b) { return a.second.bytes < b.second.bytes; })
        ->second;
  }

  const std::size_t most_clients_of_one_, most_bytes_;
  std::size_t bytes_ = 0;
  std::map<Origin, OfOne> kept_;
};

}  // namespace fjr
