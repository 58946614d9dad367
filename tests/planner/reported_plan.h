// Plans as the report's tests have them, made once.
#pragma once

#include <filesystem>
#include <string>

#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/results/plan_json.h"
#include "planner/results/report/plan_record.h"

namespace fjr {

inline const std::filesystem::path kRobot = std::filesystem::path(FJR_SOURCE_DIR) / "config" / "robot.yaml";

inline PlanRecord record_of(const std::string& request) {
  const Problem problem = parse_request(request, "reach.yaml", load_parameters(kRobot));
  Plan made = plan(problem, {});
  return {"plan.json", plan_json(problem, made), problem.robot, made.trajectory};
}

inline const PlanRecord& reach() {
  static const PlanRecord record = record_of("start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\n");
  return record;
}

}  // namespace fjr
