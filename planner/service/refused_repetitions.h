// The fractions of corrections (by the last run of a motion) that executors have refused. The number is bounded; the
// oldest are dropped first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace fjr {

class RefusedRepetitions {
 public:
  // run: the run by which the motion was corrected; fraction: of that correction, larger than 0.
  void add(const std::string& run, double fraction) {
    double least = fraction;
    if (const auto before = of(run)) least = std::min(least, *before);
    std::erase_if(refused_, [&](const auto& refused) { return refused.first == run; });
    refused_.emplace_back(run, least);
    if (refused_.size() > kMost) refused_.pop_front();
  }

  // Returns the smallest refused fraction; nothing if none was refused.
  std::optional<double> of(const std::string& run) const {
    const auto found = std::ranges::find_if(refused_, [&](const auto& refused) { return refused.first == run; });
    return found == refused_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  static constexpr std::size_t kMost = 64;

  std::deque<std::pair<std::string, double>> refused_;
};

}  // namespace fjr
