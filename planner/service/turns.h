// Distributes the shared solving slots among the services of several robots. Among the members with something to solve,
// the one whose last turn is longest ago is next. So a member with a single request waits for at most one solve of each
// other member, however many requests these have.
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

  bool ask(std::size_t member);       // reserves a slot and returns true if it is its turn; otherwise puts it in line
  void begin(std::size_t member);     // begins to solve in the reserved slot
  void withdraw(std::size_t member);  // gives the reservation back, as there is nothing to solve
  void end();                         // frees the slot at the end of a solve

 private:
  struct Member {
    std::function<void()> wake;
    bool in_line = false, has_slot = false;  // has_slot: a slot is reserved for it
    std::uint64_t last_turn = 0;
  };
  // Returns the member to wake: the first in line, if a slot is free.
  std::optional<std::size_t> next() const;
  void wake_next(std::unique_lock<std::mutex> lock);

  std::mutex mutex_;
  std::size_t free_;
  std::uint64_t turns_ = 0;
  std::vector<Member> members_;
};

// The access of one member to Turns. Without Turns it is always its turn.
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
