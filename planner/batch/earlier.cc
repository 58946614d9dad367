#include "planner/batch/earlier.h"

#include <sstream>
#include <string>

#include "common/bounded_json.h"
#include "common/input_error.h"
#include "common/read_file.h"
#include "planner/plan.h"
#include "planner/results/plan_json.h"
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

// Returns whether the document describes a motion as `fjr plan` writes it.
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
bool is_trajectory(const std::optional<std::string>& rows, const Problem& problem) {
  if (!rows) return false;
  try {
    std::istringstream in(*rows);
    const Trajectory trajectory = parse_csv(in, "trajectory");
    const auto has = [&](const char* key, const std::string& value) {
      const auto found = trajectory.metadata.find(key);
      return found != trajectory.metadata.end() && found->second == value;
    };
    return has("request_hash", problem.request_hash) && has("robot_hash", robot_hash(problem.robot)) &&
           has("rows", std::to_string(trajectory.samples.size()));
  } catch (const InputError&) {
    return false;
  }
}

std::optional<Json> plan_json_of(const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  Json plan = json_from_text<Json>(*text);
  if (!plan.is_object() || !plan.contains("status") || !plan["status"].is_string()) return std::nullopt;
  return plan;
}

bool has_settings(const Json& plan, const SearchSettings& settings) {
  return plan.value("settings", Json::object()) == settings_json(settings);
}

bool is_final(const Json& plan, const Problem& problem, bool want_proven, const SearchSettings& settings) {
  if (says(plan, "status", name(PlanStatus::kDeadline)) || says(plan, "status", name(PlanStatus::kCancelled))) {
    return false;
  }
  if (!says(plan, "version", FJR_VERSION) || !says(plan, "request_hash", problem.request_hash) ||
      !says(plan, "robot_hash", robot_hash(problem.robot)) || !has_settings(plan, settings)) {
    return false;
  }
  const bool wanted = want_proven || problem.proven;
  const PlanStatus doubtful = wanted ? PlanStatus::kCertified : PlanStatus::kUncertified;
  return !says(plan, "status", name(doubtful)) || has_proof(plan) == wanted;
}

}  // namespace

EarlierFiles files_in(const fs::path& folder) {
  return [folder](const std::string& name) { return read_file(folder / name); };
}

std::optional<Json> finished_earlier(const Problem& problem, const EarlierFiles& files, bool want_uncertified,
                                     bool want_proven, const SearchSettings& settings) {
  std::optional<Json> plan = plan_json_of(files("plan.json"));
  if (!plan || !is_final(*plan, problem, want_proven, settings)) return std::nullopt;
  if (says(*plan, "status", name(PlanStatus::kCertified)) &&
      !(is_trajectory(files("trajectory.csv"), problem) && tells_of_a_motion(*plan))) {
    return std::nullopt;
  }
  if (want_uncertified && says(*plan, "status", name(PlanStatus::kUncertified)) &&
      !is_trajectory(files("trajectory.uncertified.csv"), problem)) {
    return std::nullopt;
  }
  return plan;
}

}  // namespace fjr
