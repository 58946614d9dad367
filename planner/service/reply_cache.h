// The last replies by id, so that a repeated request is answered and never solved again. Bounded in number and bytes;
// the oldest go first.
#pragma once

#include <deque>
#include <map>

#include "planner/service/messages.h"

namespace fjr {

class ReplyCache {
 public:
  ReplyCache(std::size_t most, std::size_t most_bytes) : most_(most), most_bytes_(most_bytes) {}

  SharedReply find(const RequestId& id) const {
    const auto found = replies_.find(id);
    return found == replies_.end() ? nullptr : found->second;
  }

  void add(SharedReply reply) {
    const RequestId id = reply->id;
    const std::size_t added = size_of(*reply);
    if (!replies_.emplace(id, std::move(reply)).second) return;
    bytes_ += added;
    order_.push_back(id);
    while (order_.size() > 1 && (order_.size() > most_ || bytes_ > most_bytes_)) drop_oldest();
  }

  std::size_t size() const { return order_.size(); }

 private:
  void drop_oldest() {
    const auto found = replies_.find(order_.front());
    bytes_ -= size_of(*found->second);
    replies_.erase(found);
    order_.pop_front();
  }

  std::size_t most_, most_bytes_;
  std::size_t bytes_ = 0;
  std::map<RequestId, SharedReply> replies_;
  std::deque<RequestId> order_;  // of arrival
};

}  // namespace fjr
