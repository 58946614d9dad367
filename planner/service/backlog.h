// Requests, and cancellations, that another instance is to answer: kept in case it will not, and passed on to it in
// case it has not heard them. A cancellation is kept without its request, too, for the two come on different topics,
// and what was cancelled must not be done when it comes. Bounded; of whoever has most the oldest go first.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "planner/protocol/messages.h"

namespace fjr {

class Backlog {
 public:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    Order order;
    Clock::time_point arrived{}, heard{};  // heard: the last sign of life of its client
    bool cancelled = false;
    bool asked = true;  // false: only its cancellation has come, and of the order only id, robot and origin are known
    std::size_t relayed = 0;  // how often it was passed on
    Clock::time_point relay_at = Clock::time_point::max();
  };

  explicit Backlog(std::size_t most) : most_(most) {}

  // relay: its sender may be unknown to the one that is to answer. Returns what there is no more room for.
  std::optional<Order> add(Order order, Clock::time_point arrived, Clock::time_point heard, bool relay) {
    if (const auto known = find(order.id); known != entries_.end()) {
      known->heard = std::max(known->heard, heard);
      if (!known->asked) known->order = std::move(order);
      known->asked = true;
      if (relay) known->relay_at = std::min(known->relay_at, arrived + kPauses.front());
      return std::nullopt;
    }
    std::optional<Order> dropped = make_room();
    entries_.push_back(
        {.order = std::move(order), .arrived = arrived, .heard = heard, .relay_at = relay_from(arrived, relay)});
    return dropped;
  }
  // The same for a cancellation: of an order its id, robot and origin are enough.
  std::optional<Order> cancel(Order order, Clock::time_point arrived, bool relay) {
    std::optional<Order> dropped;
    auto found = find(order.id);
    if (found == entries_.end()) {
      dropped = make_room();
      entries_.push_back({.order = std::move(order), .arrived = arrived, .asked = false});
      found = std::prev(entries_.end());
    }
    found->cancelled = true;
    if (relay) found->relayed = 0;
    if (relay) found->relay_at = relay_from(arrived, true);
    return dropped;
  }
  // Somebody has it in hand. Whether that one has heard of its cancellation only the final reply tells.
  void accepted(const RequestId& id) {
    const auto found = find(id);
    if (found != entries_.end() && !found->cancelled) found->relay_at = Clock::time_point::max();
  }
  // By whom it was asked; all zero: unknown here.
  Origin answered(const RequestId& id) {
    const auto found = find(id);
    if (found == entries_.end()) return {};
    const Origin origin = found->order.origin;
    entries_.erase(found);
    return origin;
  }
  // What nobody waits for any more.
  template <class Overdue>
  void forget_if(Overdue&& overdue) {
    std::erase_if(entries_, overdue);
  }
  template <class Wanted>
  std::vector<Entry> take_if(Wanted&& wanted) {
    std::vector<Entry> taken;
    std::erase_if(entries_, [&](Entry& entry) {
      if (!wanted(entry)) return false;
      taken.push_back(std::move(entry));
      return true;
    });
    return taken;
  }
  std::size_t size() const { return entries_.size(); }
  std::size_t capacity() const { return most_; }

  Clock::time_point next_relay() const {
    auto next = Clock::time_point::max();
    for (const Entry& entry : entries_) next = std::min(next, entry.relay_at);
    return next;
  }
  // Calls relay(entry) for what has had no answer for a while, some at a time.
  template <class Relay>
  void relay_due(Clock::time_point now, Relay&& relay) {
    std::size_t count = 0;
    for (Entry& entry : entries_) {
      if (entry.relay_at > now || ++count > kAtOnce) continue;
      relay(entry);
      ++entry.relayed;
      entry.relay_at = entry.relayed < kPauses.size() ? now + kPauses[entry.relayed] : Clock::time_point::max();
    }
  }

 private:
  // An answer takes about a millisecond, and reliability does the rest: more than one is for an owner that did not know
  // this instance yet.
  static constexpr std::array<std::chrono::milliseconds, 5> kPauses{
      std::chrono::milliseconds(20), std::chrono::milliseconds(60), std::chrono::milliseconds(200),
      std::chrono::milliseconds(500), std::chrono::milliseconds(1000)};
  static constexpr std::size_t kAtOnce = 64;

  static Clock::time_point relay_from(Clock::time_point arrived, bool relay) {
    return relay ? arrived + kPauses.front() : Clock::time_point::max();
  }
  // What is dropped for it, if that was asked for.
  std::optional<Order> make_room() {
    std::optional<Order> dropped;
    if (entries_.size() < most_) return dropped;
    const auto oldest = oldest_of_whoever_has_most();
    if (oldest->asked) dropped = std::move(oldest->order);
    entries_.erase(oldest);
    return dropped;
  }
  std::deque<Entry>::iterator find(const RequestId& id) {
    return std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.order.id == id; });
  }
  std::deque<Entry>::iterator oldest_of_whoever_has_most() {
    std::map<Origin, std::size_t> counts;
    for (const Entry& entry : entries_) ++counts[entry.order.origin];
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return std::find_if(entries_.begin(), entries_.end(),
                        [&](const Entry& entry) { return entry.order.origin == most->first; });
  }

  std::size_t most_;
  std::deque<Entry> entries_;  // of arrival
};

}  // namespace fjr
