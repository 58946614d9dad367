// Wait-free mailboxes between the control tick and the thread that communicates over DDS.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>

namespace fjr {

// Holds at most one object. The thread that takes it owns it.
template <class T>
class Slot {
 public:
  // Returns false if the previous object has not been taken yet.
  bool put(T* thing) {
    T* none = nullptr;
    return slot_.compare_exchange_strong(none, thing, std::memory_order_acq_rel);
  }
  T* take() { return slot_.exchange(nullptr, std::memory_order_acq_rel); }

 private:
  std::atomic<T*> slot_ = nullptr;
};

// A queue from one thread to one other. put() returns false and drops the value if the queue is full.
template <class T, std::size_t kCapacity>
class Ring {
 public:
  bool put(const T& value) {
    const std::size_t next = written_.load(std::memory_order_relaxed);
    if (next - read_.load(std::memory_order_acquire) == kCapacity) return false;
    values_[next % kCapacity] = value;
    written_.store(next + 1, std::memory_order_release);
    return true;
  }
  std::optional<T> take() {
    const std::size_t next = read_.load(std::memory_order_relaxed);
    if (next == written_.load(std::memory_order_acquire)) return std::nullopt;
    const T value = values_[next % kCapacity];
    read_.store(next + 1, std::memory_order_release);
    return value;
  }

 private:
  std::array<T, kCapacity> values_{};
  std::atomic<std::size_t> written_ = 0, read_ = 0;
};

}  // namespace fjr
