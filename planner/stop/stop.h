// The parameters of a controlled stop, which are published with a trajectory.
#pragma once

#include <array>

#include "model/parameters.h"

namespace fjr {

inline constexpr int kShapes = 6;  // free parameters per joint: the end position and 5 bumps (stop_shape.h)

// Together with the plan, these numbers determine a stop; stop_rows() (stop_motion.h) computes its samples from them.
struct StopMotion {
  double time = 0;                             // [s] of the plan, at which the stop begins
  double duration = 0;                         // [s]; 0: there is no stop that ends before the plan itself
  Joints<std::array<double, kShapes>> free{};  // StopShape::free of the joints
};

}  // namespace fjr
