// The arm in motion, and the plots that share its time.
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

// Two plans, the second over the first: in the picture at the same instant, and in the plots. Both have a trajectory;
// limits are the first one's.
struct NamedPlan {
  std::string name;
  const PlanRecord& record;
};
void add_both_motions(ChartPage& page, const NamedPlan& first, const NamedPlan& second,
                      const nlohmann::ordered_json& scene, const std::vector<ReachedLimit>& limits);

// Of a request that came to no motion: start and goals, and what else was asked for in the plane.
void add_poses(ChartPage& page, const Parameters& robot, const JsonField& plan, const nlohmann::ordered_json& scene);

}  // namespace fjr
