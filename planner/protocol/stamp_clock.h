// A clock for stamps that never steps: it reads the wall clock once, and continues by the steady clock.
#pragma once

#include <chrono>
#include <cstdint>

namespace fjr {

class StampClock {
 public:
  std::int64_t now() const {
    return first_ + nanoseconds(std::chrono::steady_clock::now() - began_);
  }  // [ns] since 1970

 private:
  template <class Duration>
  static std::int64_t nanoseconds(Duration duration) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
  }

  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::int64_t first_ = nanoseconds(std::chrono::system_clock::now().time_since_epoch());
};

}  // namespace fjr
