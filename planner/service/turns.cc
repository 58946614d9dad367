#include "planner/service/turns.h"

#include <algorithm>

namespace fjr {

std::size_t Turns::join(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  members_.push_back({.wake = std::move(wake)});
  return members_.size() - 1;
}

std::optional<std::size_t> Turns::next() const {
  if (free_ == 0) return std::nullopt;
  const auto before = [](const Member& a, const Member& b) {
    return a.in_line != b.in_line ? a.in_line : a.last_turn < b.last_turn;
  };
  const auto first = std::min_element(members_.begin(), members_.end(), before);
  if (first == members_.end() || !first->in_line) return std::nullopt;
  return static_cast<std::size_t>(first - members_.begin());
}

bool Turns::ask(std::size_t member) {
  const std::lock_guard lock(mutex_);
  Member& who = members_[member];
  if (who.has_slot) return true;
  who.in_line = true;
  if (next() != member) return false;
  who = {.wake = std::move(who.wake), .has_slot = true, .last_turn = ++turns_};
  --free_;
  return true;
}

void Turns::begin(std::size_t member) {
  const std::lock_guard lock(mutex_);
  members_[member].has_slot = false;
}

void Turns::withdraw(std::size_t member) {
  std::unique_lock lock(mutex_);
  Member& who = members_[member];
  if (!who.in_line && !who.has_slot) return;
  if (std::exchange(who.has_slot, false)) ++free_;
  who.in_line = false;
  wake_next(std::move(lock));
}

void Turns::end() {
  std::unique_lock lock(mutex_);
  ++free_;
  wake_next(std::move(lock));
}

void Turns::wake_next(std::unique_lock<std::mutex> lock) {
  const auto who = next();
  if (!who) return;
  const auto wake = members_[*who].wake;
  lock.unlock();
  wake();
}

}  // namespace fjr
