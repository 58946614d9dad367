#include "planner/batch/earlier.h"

#include <string>

#include "common/input_error.h"
#include "common/read_file.h"
#include "planner/plan.h"
#include "planner/results/planned_motion.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

bool says(const Json& plan, const char* key, const std::string& text) {
  const auto found = plan.find(key);
  return found != plan.end() && found->is_string() && found->get_ref<const std::string&>() == text;
}

// Whether it tells of a motion as fjr plan does, and not of some other thing, or none.
bool tells_of_a_motion(const Json& plan) {
  try {
    (void)planned_motion_in(plan, "plan.json");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

bool has_proof(const Json& plan) { return plan.value(Json::json_pointer("/certificate/proof"), Json()).is_object(); }

// A file that was cut short or belongs to another plan is no result.
bool has_trajectory(const fs::path& file, const Problem& problem, const std::string& hash) {
  try {
    const Trajectory trajectory = read_csv(file);
    const auto has = [&](const char* key, const std::string& value) {
      const auto found = trajectory.metadata.find(key);
      return found != trajectory.metadata.end() && found->second == value;
    };
    return has("request_hash", problem.request_hash) && has("robot_hash", hash) &&
           has("rows", std::to_string(trajectory.samples.size()));
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

std::optional<Json> read_plan_json(const fs::path& folder) {
  const std::optional<std::string> text = read_file(folder / "plan.json");
  if (!text) return std::nullopt;
  Json plan = Json::parse(*text, nullptr, false);
  if (!plan.is_object() || !plan.contains("status") || !plan["status"].is_string()) return std::nullopt;
  return plan;
}

bool is_final(const Json& plan, const Problem& problem, bool want_proven) {
  if (says(plan, "status", name(PlanStatus::kDeadline)) || says(plan, "status", name(PlanStatus::kCancelled))) {
    return false;
  }
  if (!says(plan, "version", FJR_VERSION) || !says(plan, "request_hash", problem.request_hash) ||
      !says(plan, "robot_hash", robot_hash(problem.robot))) {
    return false;
  }
  const bool wanted = want_proven || problem.proven;
  const PlanStatus doubtful = wanted ? PlanStatus::kCertified : PlanStatus::kUncertified;
  return !says(plan, "status", name(doubtful)) || has_proof(plan) == wanted;
}

std::optional<Json> finished_earlier(const Problem& problem, const fs::path& folder, bool want_uncertified,
                                     bool want_proven) {
  std::optional<Json> plan = read_plan_json(folder);
  if (!plan || !is_final(*plan, problem, want_proven)) return std::nullopt;
  const std::string hash = robot_hash(problem.robot);
  if (says(*plan, "status", name(PlanStatus::kCertified)) &&
      !(has_trajectory(folder / "trajectory.csv", problem, hash) && tells_of_a_motion(*plan))) {
    return std::nullopt;
  }
  if (want_uncertified && says(*plan, "status", name(PlanStatus::kUncertified)) &&
      !has_trajectory(folder / "trajectory.uncertified.csv", problem, hash)) {
    return std::nullopt;
  }
  return plan;
}

}  // namespace fjr
