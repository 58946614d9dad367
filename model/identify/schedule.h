// When the steps of a staircase begin.
#pragma once

#include <string>
#include <vector>

#include "model/log.h"

namespace fjr {

struct Schedule {
  double start, period, average;  // [s]  of the first step; of each; at the end of each, to be averaged
};

// From metadata `period` and `average` and from the motor's own moves (theta<joint>_plan where the log has it). Without
// metadata and recognisable moves 10 s of which 2 s are averaged, as in the paper, with a warning.
Schedule schedule_of(const Log& log, int joint, std::vector<std::string>& warnings);

}  // namespace fjr
