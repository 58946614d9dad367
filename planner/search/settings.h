// Settings of the continuation that an expert may change.
#pragma once

#include <cstddef>
#include <string>

#include "planner/collocation/scheme.h"

namespace fjr {

struct ContinuationSettings {
  Scheme scheme = hermite_simpson();
  double mesh_tolerance = 3e-6;  // [rad] error of an interval; some hundred of them stay within half a count together
  double shortest_interval = 2.5e-4;  // [s] refinement stops there: a switch inside costs less than the tolerance
  int warm_iterations = 150;
  // Most intervals of a mesh; fewer if a task adds rows. Memory grows with them, by 70 kB an interval without a task.
  std::size_t most_intervals = 2500;
  std::string linear_solver = "stage";
};

}  // namespace fjr
