// What planning the same move without the springs would have cost.
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

// The plan first, and then the textbook's profiles of the same duration; all followed by the same controller on the
// same elastic arm. Empty where the plan does not lead from rest to rest.
std::vector<ComparedMotion> compared_motions(const Parameters& robot, const Trajectory& plan);

// with_scene: the request asks for something on the way.
void add_comparison(ChartPage& page, const Parameters& robot, const std::vector<ComparedMotion>& motions,
                    const Trajectory& plan, const std::vector<WeightedTerm>& objective,
                    const std::vector<ReachedLimit>& limits, bool with_scene);

}  // namespace fjr
