// Optimises the times of nodes of the mesh together with the motion.
//
// Where a motor comes to rest or starts from rest, the optimal torque jumps, and the mesh can represent a jump only at
// a node. On a fixed mesh the optimiser cannot find a motion that jumps a little earlier or later, even if it is
// better. The Hamiltonian (planner/collocation/adjoint.h) then jumps at the node by d objective / d (time of the node).
#pragma once

#include <cstddef>
#include <vector>

#include "planner/ocp/collocate.h"

namespace fjr {

// Solves the problem again from its solution `start`, with the times of the given inner nodes (increasing) as decision
// variables. All other nodes keep their relative places between them. No piece between moving nodes becomes more than
// twice or less than half as long. The result is a solution on the moved mesh; its status is kFailed if `start` has no
// complete multipliers. The problem must not have a slack.
Collocated move_nodes(const Problem& problem, const Collocated& start, const std::vector<std::size_t>& nodes,
                      const SolveOptions& options);

}  // namespace fjr
