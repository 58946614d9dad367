// Nodes of the mesh whose times are optimised too.
//
// Where a motor comes to rest or leaves it the optimal torque jumps, which a mesh can follow only where it has a node.
// A motion that jumps a little earlier or later is worse on this mesh, even if it is better on one whose node is there:
// the optimiser cannot find it. H (planner/collocation/adjoint.h) then jumps at the node by d objective / d (time of
// the node).
#pragma once

#include <cstddef>
#include <vector>

#include "planner/ocp/collocate.h"

namespace fjr {

// Solves again from `start`, a solution of this problem, with the times of these inner nodes (increasing) as variables.
// The others keep their places between them in proportion. The result is a solution on the mesh as it came to lie.
// Between moving nodes no stretch becomes more than twice or less than half as long. Not for problems with slack.
Collocated move_nodes(const Problem& problem, const Collocated& start, const std::vector<std::size_t>& nodes,
                      const SolveOptions& options);

}  // namespace fjr
