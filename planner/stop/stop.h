// A controlled stop, as it goes with a trajectory.
#pragma once

#include <array>

#include "model/parameters.h"

namespace fjr {

inline constexpr int kShapes = 6;  // free numbers per joint: where it ends, and the bumps

// What determines a stop, beside the plan that it leaves: the rows follow from it (stop_rows(), stop_motion.h).
struct StopMotion {
  double time = 0;                             // [s] of the plan, when it begins
  double duration = 0;                         // [s]; 0: no stop is over sooner than the plan itself
  Joints<std::array<double, kShapes>> free{};  // StopShape::free of the joints
};

}  // namespace fjr
