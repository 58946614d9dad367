// The arm in motion, and the plots that share its time.
#pragma once

#include <vector>

#include "common/chart_page.h"
#include "planner/results/report/comparison_section.h"
#include "planner/results/report/plan_record.h"

namespace fjr {

// `record` has a trajectory; `scene` is what is drawn with the arm (scene.h).
void add_motion(ChartPage& page, const PlanRecord& record, const nlohmann::ordered_json& scene,
                const std::vector<ReachedLimit>& limits, const std::vector<ComparedMotion>& motions);

}  // namespace fjr
