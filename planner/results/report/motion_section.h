// The animation of the arm, and plots with the same time axis.
#pragma once

#include <string>
#include <vector>

#include "common/chart_page.h"
#include "planner/results/report/comparison_section.h"
#include "planner/results/report/plan_record.h"

namespace fjr {

// `record` has a trajectory; `scene` is what is drawn with the arm (scene.h).
void add_motion(ChartPage& page, const PlanRecord& record, const nlohmann::ordered_json& scene,
                const std::vector<ReachedLimit>& limits, const std::vector<ComparedMotion>& motions);

// Shows the second plan over the first, in the picture at the same time and in the plots. Both must have a trajectory;
// the limits are those of the first.
struct NamedPlan {
  std::string name;
  const PlanRecord& record;
};
void add_both_motions(ChartPage& page, const NamedPlan& first, const NamedPlan& second,
                      const nlohmann::ordered_json& scene, const std::vector<ReachedLimit>& limits);

// Shows a request for which no motion was found: start, goals and task constraints.
void add_poses(ChartPage& page, const Parameters& robot, const JsonField& plan, const nlohmann::ordered_json& scene);

}  // namespace fjr
