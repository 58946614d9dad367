// Encloses the motion of the exact arm under a trajectory, piece by piece of a rollout.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/enclosure/flow.h"
#include "planner/certificate/comparison.h"
#include "planner/certificate/proof/row_polynomials.h"

namespace fjr {

inline constexpr std::size_t kArmOrder = 12;  // of the steps' polynomials, the last coefficient being the remainder

// One step of the enclosure: [from, from + length] in `plan`'s time.
struct ArmStep {
  double time;                               // [s] about when it begins
  const RowPolynomials& plan;                // of the time since the step began
  const enclosure::Step<kStates>& solution;  // likewise
};

// Result of follow().
struct Followed {
  bool completed = false;  // the end was reached; else the observer returned false, or no enclosure was found
  double until = 0;        // [s]
  double width = 0;        // [rad] of the links, largest radius
  long steps = 0;
};

// Follows the arm through these pieces and calls observe for every step until it returns false.
Followed follow(const Parameters& robot, const Trajectory& trajectory, const std::vector<Piece>& pieces,
                const std::function<bool(const ArmStep&)>& observe);

}  // namespace fjr
