// `fjr identify executed`: robot.yaml refined by ordinary motions that the executor logged.
#pragma once

#include <string>
#include <vector>

#include "model/log.h"
#include "planner/identify/prior.h"

namespace fjr {

struct ExecutedArguments {
  std::vector<std::string> logs;
  std::string robot, out;  // robot empty: the one shipped; out empty: nothing is written
  ColumnNames renamed;
  double widen = 1;
  PayloadMass payload = PayloadMass::kUncertain;
  bool json = false;
};

// Returns the exit code.
int identify_executed(const ExecutedArguments& options);

}  // namespace fjr
