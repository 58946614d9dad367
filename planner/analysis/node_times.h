// Checks by the Hamiltonian whether the nodes of a solution's mesh lie at the optimal times.
#pragma once

#include <cstddef>
#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"

namespace fjr {

struct NodeTimes {
  double spread = 0;               // of H, including its jumps at nodes
  double allowed = 0;              // spread, and jump at a node, up to which the node times count as optimal
  std::vector<std::size_t> jumps;  // inner nodes, except via points, where H jumps by more than `allowed`
};

NodeTimes node_times(const Problem& problem, const Collocated& solution);

}  // namespace fjr
