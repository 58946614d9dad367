// The owners of a robot are numbered (ownership.h): each takes the epoch one above the largest it has heard of.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace fjr {

// An epoch that is further above what the executor ran last is refused, for anybody in a domain without DDS Security
// can say one, and after the largest number there is no next. Owners that follow each other once a second get there
// after half a year without a single motion, so that none is refused by mistake. Whoever goes as far as is allowed with
// every motion needs 127 motions until the ownership strength of DDS (31 bits) does not tell owners apart any more, and
// 2^40 until there is no next.
inline constexpr std::uint64_t kEpochJump = std::uint64_t{1} << 24;

inline std::uint64_t largest_believed(std::uint64_t seen) {
  return seen + std::min(kEpochJump, std::numeric_limits<std::uint64_t>::max() - seen);
}

}  // namespace fjr
