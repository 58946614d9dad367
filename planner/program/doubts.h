// What is improbable about robots, told to people.
#pragma once

#include "model/parameters.h"

namespace fjr {

// A warning on stderr for each doubt about the robot (model/plausibility.h), none of them twice.
void tell_doubts(const Parameters& robot);

}  // namespace fjr
