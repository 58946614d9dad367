// Determines when the steps of a staircase begin.
#pragma once

#include <string>
#include <vector>

#include "model/log.h"

namespace fjr {

struct Schedule {
  double start, period, average;  // [s]  of the first step; of each; at the end of each, to be averaged
};

// Uses the metadata `period` and `average` and the moves of the motor (theta<joint>_plan, if the log has it). Without
// metadata and recognisable moves, assumes 10 s of which 2 s are averaged, as in the paper, and adds a warning.
Schedule schedule_of(const Log& log, int joint, std::vector<std::string>& warnings);

}  // namespace fjr
