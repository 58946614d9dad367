// Limits the log lines per second, so that a flood of requests does not flood the log.
#pragma once

#include <spdlog/spdlog.h>

#include <chrono>

namespace fjr {

class LogLimit {
 public:
  // Returns true for the first few calls in a second. The number of lines left out is logged with the first of the next
  // second.
  bool allows() {
    const auto now = std::chrono::steady_clock::now();
    if (now - began_ > std::chrono::seconds(1)) {
      if (count_ > kPerSecond) spdlog::warn("{} similar lines left out", count_ - kPerSecond);
      began_ = now;
      count_ = 0;
    }
    return ++count_ <= kPerSecond;
  }

 private:
  static constexpr int kPerSecond = 20;
  std::chrono::steady_clock::time_point began_{};
  int count_ = 0;
};

}  // namespace fjr
