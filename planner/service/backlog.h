// Requests and cancellations that another instance should answer. They are kept in case it fails, and relayed to it in
// case it has not received them. A cancellation is also kept without its request, because the two arrive on different
// topics and a cancelled request must not be carried out when it arrives later. The number is bounded; when full, the
// oldest entry of the participant with the most entries is dropped.
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
    bool asked = true;        // false: only the cancellation has arrived, and the order has only id, robot and origin
    std::size_t relayed = 0;  // how often it was passed on
    Clock::time_point relay_at = Clock::time_point::max();
  };

  explicit Backlog(std::size_t most) : most_(most) {}

  // Adds a request. relay: pass it on, since the instance that answers may not know its sender. Returns the request
  // that was dropped because of lack of space, if any.
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
  // Adds a cancellation. The order needs only id, robot and origin.
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
  // An instance has accepted the request, so it is no longer relayed. A cancelled one still is, because only the final
  // reply shows that the instance has received the cancellation.
  void accepted(const RequestId& id) {
    const auto found = find(id);
    if (found != entries_.end() && !found->cancelled) found->relay_at = Clock::time_point::max();
  }
  // Removes a request that has been answered. Returns the participant that sent it; all zero if it is not known here.
  Origin answered(const RequestId& id) {
    const auto found = find(id);
    if (found == entries_.end()) return {};
    const Origin origin = found->order.origin;
    entries_.erase(found);
    return origin;
  }
  // Drops entries that no client waits for any more.
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
  // Calls relay(entry) for entries that have had no answer for a while, at most kAtOnce at a time.
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
  // Pauses between relays. An answer takes about a millisecond and DDS is reliable, so a repeated relay only helps if
  // the owner had not discovered this instance before.
  static constexpr std::array<std::chrono::milliseconds, 5> kPauses{
      std::chrono::milliseconds(20), std::chrono::milliseconds(60), std::chrono::milliseconds(200),
      std::chrono::milliseconds(500), std::chrono::milliseconds(1000)};
  static constexpr std::size_t kAtOnce = 64;

  static Clock::time_point relay_from(Clock::time_point arrived, bool relay) {
    return relay ? arrived + kPauses.front() : Clock::time_point::max();
  }
  // Drops an entry if there is no room. Returns its request, if that had arrived.
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
