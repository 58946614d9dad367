// Warnings about improbable robots.
#pragma once

#include "model/parameters.h"

namespace fjr {

// Prints a warning on stderr for each doubt about the robot (model/plausibility.h), none of them twice.
void tell_doubts(const Parameters& robot);

}  // namespace fjr
