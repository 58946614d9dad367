// Whether the nodes of a solution's mesh lie where the optimum wants them.
#pragma once

#include <cstddef>
#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"

namespace fjr {

struct NodeTimes {
  double spread = 0;               // of H, whatever it jumps by
  double allowed = 0;              // of it
  std::vector<std::size_t> jumps;  // inner nodes, not via points, where H jumps by more than that
};

NodeTimes node_times(const Problem& problem, const Collocated& solution);

}  // namespace fjr
