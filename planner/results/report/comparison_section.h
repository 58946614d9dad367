// A section that compares the plan with profiles that ignore the springs.
#pragma once

#include <string>
#include <vector>

#include "common/chart_page.h"
#include "planner/results/report/objective_text.h"
#include "planner/results/report/plan_limits.h"
#include "planner/results/report/rigid_profile.h"

namespace fjr {

struct ComparedMotion {
  std::string name;
  const char* colour;
  ElasticRun run;
};

// Returns the plan, followed by textbook profiles of the same duration, all executed by the same controller on the same
// elastic arm. Empty if the plan does not lead from rest to rest.
std::vector<ComparedMotion> compared_motions(const Parameters& robot, const Trajectory& plan);

// with_scene: whether the request has task constraints.
void add_comparison(ChartPage& page, const Parameters& robot, const std::vector<ComparedMotion>& motions,
                    const Trajectory& plan, const std::vector<WeightedTerm>& objective,
                    const std::vector<ReachedLimit>& limits, bool with_scene);

}  // namespace fjr
