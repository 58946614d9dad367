// The last replies by id, so that a repeated request is answered and not solved again. Certified trajectories, which
// can be executed later, are kept apart from other replies, so that a thousand refusals do not displace a trajectory.
// Both kinds are bounded in number and bytes; when full, the oldest of the participant with the most is dropped.
#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "planner/protocol/messages.h"

namespace fjr {

// Returns whether a reply with this reason may be remembered. If the answer may be different later or elsewhere, it may
// not, and the same request can be sent again.
inline bool lasting(Reason reason) {
  return reason != Reason::kQueueFull && reason != Reason::kArmNotAtRest && reason != Reason::kNoTrajectory &&
         reason != Reason::kShuttingDown && reason != Reason::kClientGone;
}

class ReplyCache {
 public:
  // The bounds apply to each kind.
  ReplyCache(std::size_t most, std::size_t most_bytes) : trajectories_(most, most_bytes), others_(most, most_bytes) {}

  SharedReply find(const RequestId& id) const {
    SharedReply found = trajectories_.find(id);
    return found ? found : others_.find(id);
  }

  // Returns a reply with a trajectory that satisfies which(reply), or null.
  template <class Which>
  SharedReply find_trajectory(Which&& which) const {
    return trajectories_.find_if(which);
  }

  // Adds a reply. Returns the ids of the replies that were dropped for it.
  std::vector<RequestId> add(SharedReply reply) {
    if (find(reply->id)) return {};
    return (reply->state == ReplyState::kSolved ? trajectories_ : others_).add(std::move(reply));
  }

  std::size_t size() const { return trajectories_.size() + others_.size(); }

 private:
  class Kind {
   public:
    Kind(std::size_t most, std::size_t most_bytes) : most_(most), most_bytes_(most_bytes) {}

    SharedReply find(const RequestId& id) const {
      const auto found = replies_.find(id);
      return found == replies_.end() ? nullptr : found->second;
    }

    template <class Which>
    SharedReply find_if(Which&& which) const {
      const auto found =
          std::find_if(replies_.begin(), replies_.end(), [&](const auto& reply) { return which(*reply.second); });
      return found == replies_.end() ? nullptr : found->second;
    }

    std::vector<RequestId> add(SharedReply reply) {
      const RequestId id = reply->id;
      bytes_ += size_of(*reply);
      of_each_[reply->origin].push_back({++added_, id});
      replies_.emplace(id, std::move(reply));
      std::vector<RequestId> dropped;
      while (size() > 1 && (size() > most_ || bytes_ > most_bytes_)) dropped.push_back(drop_one());
      return dropped;
    }

    std::size_t size() const { return replies_.size(); }

   private:
    RequestId drop_one() {
      const auto most = std::max_element(of_each_.begin(), of_each_.end(), [](const auto& a, const auto& b) {
        return std::pair(a.second.size(), b.second.front().added) < std::pair(b.second.size(), a.second.front().added);
      });
      const RequestId id = most->second.front().id;
      const auto oldest = replies_.find(id);
      bytes_ -= size_of(*oldest->second);
      replies_.erase(oldest);
      most->second.pop_front();
      if (most->second.empty()) of_each_.erase(most);
      return id;
    }

    std::size_t most_, most_bytes_;
    std::size_t bytes_ = 0;
    std::map<RequestId, SharedReply> replies_;
    struct Entry {
      std::uint64_t added;  // sequence number
      RequestId id;
    };
    std::uint64_t added_ = 0;
    std::map<Origin, std::deque<Entry>> of_each_;  // of arrival
  };

  Kind trajectories_, others_;
};

}  // namespace fjr
