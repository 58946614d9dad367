// fjr.Plan: what became of a request, and its arrays.
#pragma once

#include <memory>

#include "planner/ocp/collocate.h"
#include "planner/results/report/plan_record.h"

namespace fjr::python {

// A plan as it would lie in its folder, without one.
struct Planned {
  PlanRecord record;                           // its trajectory is there whatever its certificate says
  std::shared_ptr<const Collocated> solution;  // for warm starts; none where it was not told
};

}  // namespace fjr::python
