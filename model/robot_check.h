// Checks the capabilities of an arm: whether springs and motors hold it, what its encoders resolve, how far it reaches.
#pragma once

#include <vector>

#include "model/parameters.h"
#include "model/plausibility.h"

namespace fjr {

// Returns findings_about(p), and findings about the capabilities of the arm with its payload and mounting. Impossible
// ones are those that load_parameters() refuses.
std::vector<Finding> check_robot(const Parameters& p);

}  // namespace fjr
