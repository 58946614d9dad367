// Decides how long to look for a participant: until nothing new was discovered for a given time, and at most ten times
// as long in all. With DDS Security every two participants perform a handshake. With many clients at once that takes
// longer than any fixed timeout.
#pragma once

#include <algorithm>
#include <chrono>

namespace fjr {

class Patience {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Patience(double seconds) : seconds_(seconds) {}

  static double since(Clock::time_point start) { return seconds(Clock::now() - start); }  // [s]

  void progressed() { last_ = Clock::now(); }
  double looked() const { return since(began_); }      // [s]
  double nothing_new() const { return since(last_); }  // [s] since the last progress, or the beginning
  bool over(double under_way = 0) const {              // [s] extra time for handshakes that may be under way
    return nothing_new() > seconds_ + under_way || looked() > kMost * seconds_;
  }

 private:
  static constexpr double kMost = 10;
  static double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

  double seconds_;
  Clock::time_point began_ = Clock::now(), last_ = began_;
};

}  // namespace fjr
