// Epochs number the owners of a robot (ownership.h). Each owner takes the number above the largest it has heard of.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace fjr {

// Largest increase over the last epoch that the executor ran; larger ones are refused. In a domain without DDS Security
// anybody can state an epoch, and after the largest number there is no next one. Owners that follow each other once a
// second reach this increase after half a year without a single motion, so that none is refused by mistake. An attacker
// who uses it fully with every motion needs 127 motions until the ownership strength of DDS (31 bits) cannot
// distinguish owners any more, and 2^40 until there is no next epoch.
inline constexpr std::uint64_t kEpochJump = std::uint64_t{1} << 24;

inline std::uint64_t largest_believed(std::uint64_t seen) {
  return seen + std::min(kEpochJump, std::numeric_limits<std::uint64_t>::max() - seen);
}

}  // namespace fjr
