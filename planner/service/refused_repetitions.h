// The last repetition of each motion that an executor refused. Bounded; the oldest go first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <utility>

#include "planner/protocol/messages.h"

namespace fjr {

class RefusedRepetitions {
 public:
  void add(SharedReply refused) {
    std::erase_if(refused_, [&](const SharedReply& other) { return other->motion == refused->motion; });
    refused_.push_back(std::move(refused));
    if (refused_.size() > kMost) refused_.pop_front();
  }

  // motion: id that it was planned under. Null: there is none.
  SharedReply of(const RequestId& motion) const {
    const auto found =
        std::ranges::find_if(refused_, [&](const SharedReply& refused) { return refused->motion == motion; });
    return found == refused_.end() ? nullptr : *found;
  }

 private:
  static constexpr std::size_t kMost = 64;

  std::deque<SharedReply> refused_;
};

}  // namespace fjr
