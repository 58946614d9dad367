// Moves nodes of a solution's mesh to their optimal times.
#pragma once

#include "planner/search/attempts.h"

namespace fjr {

// Moves the nodes at which the Hamiltonian jumps to their optimal times, where friction is in the objective.
ChangeOutcome move_jumps(Attempts& attempts);

}  // namespace fjr
