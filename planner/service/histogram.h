// A cumulative histogram of durations as Prometheus defines it, with bounds that grow by a factor of about two.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace fjr {

class Histogram {
 public:
  static constexpr std::array<double, 15> kBounds{0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25,
                                                  0.5,   1,      2.5,   5,    10,    60,   600};  // [s]

  void add(double seconds) {
    for (std::size_t i = 0; i < kBounds.size(); ++i) {
      if (seconds <= kBounds[i]) ++at_most_[i];
    }
    ++count_;
    sum_ += seconds;
  }

  std::uint64_t at_most(std::size_t bound) const { return at_most_[bound]; }  // all that took at most kBounds[bound]
  std::uint64_t count() const { return count_; }
  double sum() const { return sum_; }  // [s]

 private:
  std::array<std::uint64_t, kBounds.size()> at_most_{};
  std::uint64_t count_ = 0;
  double sum_ = 0;
};

}  // namespace fjr
