// What an expert may change about the solves.
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
  // Beyond that a mesh is not refined, beyond fewer where a task adds rows: memory grows with it, by 70 kB an interval
  // without a task.
  std::size_t most_intervals = 2500;
  std::string linear_solver = "stage";
};

}  // namespace fjr
