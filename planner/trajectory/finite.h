// Rows that hold NaN or infinity are no motion.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "planner/trajectory/trajectory.h"

namespace fjr {

// Returns true if all numbers of the row are finite.
inline bool is_finite(const Sample& row) {
  const auto finite = [](double value) { return std::isfinite(value); };
  std::array<double, kStates> state{};
  row.state.copy_to(state.data());
  return finite(row.time) && std::all_of(state.begin(), state.end(), finite) &&
         std::all_of(row.torque.begin(), row.torque.end(), finite);
}

inline bool all_finite(const std::vector<Sample>& rows) { return std::all_of(rows.begin(), rows.end(), is_finite); }

}  // namespace fjr
