// What an arm can do: whether springs and motors hold it, what its encoders see, how far it reaches.
#pragma once

#include <vector>

#include "model/parameters.h"
#include "model/plausibility.h"

namespace fjr {

// findings_about(p), and what the arm is able to, with its payload and as it is mounted. What is impossible here is
// what load_parameters() refuses.
std::vector<Finding> check_robot(const Parameters& p);

}  // namespace fjr
