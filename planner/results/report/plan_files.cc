#include "planner/results/report/plan_files.h"

#include <nlohmann/json.hpp>

#include "common/atomic_file.h"
#include "planner/results/plan_json.h"
#include "planner/results/planned_with.h"
#include "planner/results/repetition_json.h"
#include "planner/results/report/plan_page.h"
#include "planner/results/solution_file.h"
#include "planner/results/strict_json.h"

namespace fjr {

namespace fs = std::filesystem;

void describe(Trajectory& trajectory, const nlohmann::ordered_json& plan) {
  for (const char* key : {"request", "request_hash", "robot_hash", "status", "version"}) {
    trajectory.metadata[key] = plan.at(key).get<std::string>();
  }
  trajectory.metadata["rows"] = std::to_string(trajectory.samples.size());  // to detect truncated files
  tell_planned_with(plan, trajectory.metadata);
  tell_repetition(plan, trajectory.metadata);
}

std::vector<std::string> write_plan_files(const PlanFiles& files, const fs::path& folder, bool keep_uncertified) {
  std::vector<std::string> names;
  const bool certified = files.plan.at("status") == name(PlanStatus::kCertified);
  if (files.trajectory != nullptr && (certified || keep_uncertified)) {
    names.emplace_back(certified ? "trajectory.csv" : "trajectory.uncertified.csv");
    write_csv(*files.trajectory, folder / names.back());
    if (files.solution != nullptr) {
      write_solution(folder / kSolutionFile, *files.solution, files.plan.at("robot_hash").get<std::string>());
    }
  }
  write_file(folder / "plan.json", json_text(files.plan));
  names.emplace_back("plan.json");
  return names;
}

fs::path write_report(const fs::path& folder) {
  const fs::path file = folder / "report.html";
  const PlanRecord plan = read_plan(folder);
  write_file(file, reading(plan.source, [&plan] { return plan_page(plan); }));
  return file;
}

}  // namespace fjr
