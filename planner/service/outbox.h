// Replies that their clients have no room for yet. The replies of a client stay in order, and no client makes another
// wait.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "planner/protocol/messages.h"

namespace fjr {

class Outbox {
 public:
  using Clock = std::chrono::steady_clock;
  using Send = std::function<bool(const SharedReply&)>;  // false: the client has no room now

  Outbox(Send send, std::size_t most_bytes) : send_(std::move(send)), most_bytes_(most_bytes) {}

  // Posts a reply. Returns false if there was too much to keep: then the oldest reply of the client furthest behind was
  // dropped, and that client has to ask again.
  bool post(SharedReply reply) {
    const auto behind = waiting_.find(reply->id.client);
    if (behind == waiting_.end() && send_(reply)) return true;
    Client& client = behind == waiting_.end() ? waiting_[reply->id.client] : behind->second;
    if (waiting_.size() == 1 && client.replies.empty()) next_ = Clock::now() + (pause_ = kShortest);
    bytes_ += size_of(*reply);
    client.bytes += size_of(*reply);
    client.replies.push_back(std::move(reply));
    bool all_kept = true;
    for (; bytes_ > most_bytes_; all_kept = false) drop_one();
    return all_kept;
  }

  // Sends the replies for which there is room by now, only a few per client so that it does not take long; the rest is
  // due again at once. If very many clients wait, they take turns.
  void deliver() {
    if (waiting_.empty() || Clock::now() < next_) return;
    bool progress = false, more = false;
    auto client = waiting_.upper_bound(last_);
    for (std::size_t left = std::min(waiting_.size(), kClientsAtOnce); left > 0; --left) {
      if (client == waiting_.end()) client = waiting_.begin();
      last_ = client->first;
      auto& replies = client->second.replies;
      int sent = 0;
      for (; sent < kAtOnce && !replies.empty() && send_(replies.front()); ++sent) remove_oldest(client->second);
      progress = progress || sent > 0;
      more = more || sent == kAtOnce;
      client = replies.empty() ? waiting_.erase(client) : std::next(client);
    }
    pause_ = progress ? kShortest : std::min(2 * pause_, kLongest);
    next_ = more ? Clock::now() : Clock::now() + pause_;
  }

  bool empty() const { return waiting_.empty(); }
  Clock::time_point next() const { return waiting_.empty() ? Clock::time_point::max() : next_; }

 private:
  struct Client {
    std::deque<SharedReply> replies;
    std::size_t bytes = 0;
  };

  // DDS does not notify when there is room. So sending is tried again, with pauses that grow while nothing can be sent.
  static constexpr Clock::duration kShortest = std::chrono::milliseconds(1), kLongest = std::chrono::milliseconds(50);

  static constexpr int kAtOnce = 8;
  static constexpr std::size_t kClientsAtOnce = 1024;  // for whom there may be no room; looking takes about 3 ms

  void remove_oldest(Client& client) {
    const std::size_t size = size_of(*client.replies.front());
    bytes_ -= size;
    client.bytes -= size;
    client.replies.pop_front();
  }

  void drop_one() {
    const auto furthest = std::max_element(
        waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) { return a.second.bytes < b.second.bytes; });
    remove_oldest(furthest->second);
    if (furthest->second.replies.empty()) waiting_.erase(furthest);
  }

  const Send send_;
  const std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::map<decltype(RequestId::client), Client> waiting_;
  decltype(RequestId::client) last_{};  // that was looked at
  Clock::duration pause_ = kShortest;
  Clock::time_point next_{};
};

}  // namespace fjr
