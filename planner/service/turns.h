// Whose turn it is to solve, where the services of several robots share what can be solved at a time. Of those who have
// something to solve it is the turn of whoever had one longest ago: one of them that comes with a single request waits
// for at most one solve of each of the others, however many requests these have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace fjr {

// May be called from any thread.
class Turns {
 public:
  explicit Turns(std::size_t slots) : free_(slots) {}

  // `wake` is called, from other threads, when it may be the member's turn.
  std::size_t join(std::function<void()> wake);

  bool ask(std::size_t member);       // whether it is its turn; a slot is then kept for it. If not, it is in line.
  void begin(std::size_t member);     // solving, in the slot that was kept for it
  void withdraw(std::size_t member);  // it has nothing to solve for the moment
  void end();                         // of a solve: its slot is free

 private:
  struct Member {
    std::function<void()> wake;
    bool in_line = false, has_slot = false;  // has_slot: kept for it
    std::uint64_t last_turn = 0;
  };
  // Who is to be woken: the first in line, if there is a slot for it.
  std::optional<std::size_t> next() const;
  void wake_next(std::unique_lock<std::mutex> lock);

  std::mutex mutex_;
  std::size_t free_;
  std::uint64_t turns_ = 0;
  std::vector<Member> members_;
};

// One member's part in it. Without others it is always its turn.
class Turn {
 public:
  Turn() = default;
  Turn(std::shared_ptr<Turns> turns, std::function<void()> wake) : turns_(std::move(turns)) {
    if (turns_) member_ = turns_->join(std::move(wake));
  }

  bool ask() const { return !turns_ || turns_->ask(member_); }
  void begin() const {
    if (turns_) turns_->begin(member_);
  }
  void withdraw() const {
    if (turns_) turns_->withdraw(member_);
  }
  void end() const {
    if (turns_) turns_->end();
  }

 private:
  std::shared_ptr<Turns> turns_;
  std::size_t member_ = 0;
};

}  // namespace fjr
