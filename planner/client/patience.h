// How long to look for somebody: as long as ever more of the others are met, and so long beyond it; ten times that at
// most. With DDS Security everybody shakes hands with everybody, which takes many clients at once longer than any fixed
// time.
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
  bool over(double under_way = 0) const {              // [s] that what is under way may take beyond the usual
    return nothing_new() > seconds_ + under_way || looked() > kMost * seconds_;
  }

 private:
  static constexpr double kMost = 10;
  static double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

  double seconds_;
  Clock::time_point began_ = Clock::now(), last_ = began_;
};

}  // namespace fjr
