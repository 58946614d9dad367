#include "planner/service/find_repetition.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "common/bounded_json.h"
#include "common/input_error.h"
#include "model/log.h"
#include "planner/certificate/consistency.h"
#include "planner/learning/repetition.h"
#include "planner/results/plan_json.h"
#include "planner/results/planned_with.h"
#include "planner/results/repetition_json.h"
#include "planner/results/verification.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

Limits limits_of_plan(const Parameters& robot, const Json& plan) {
  Metadata header;
  tell_planned_with(plan, header);
  return limits_of(robot, planned_with(header, "plan.json"));
}

// Returns where the motors began in earlier runs. If another version has written these in a form that cannot be read,
// they are removed from `plan`.
std::optional<Joints<double>> motors_began_by(Json& plan) {
  try {
    return motors_began_before({plan, "plan.json"});
  } catch (const InputError&) {
    plan["repetition"].erase("runs");
    return std::nullopt;
  }
}

Repetition next(const Parameters& robot, const Json& plan, const RunOfMotion& run, const RepetitionHistory& history) {
  const Trajectory executed{run.rows, {}};
  const PlannedMotion planned = planned_motion_in(plan, "plan.json");
  const TaskOfMotion task = TaskOfMotion::of(robot, planned.task, planned.ends);
  const Limits limits = limits_of_plan(robot, plan);
  Log log = log_of(run.ticks, run.missed_ticks);
  log.source = "the run " + run.run;
  try {
    require_run_of(executed, "the trajectory", log);
    return next_repetition(robot, limits, task, executed, executed_motion(log), history);
  } catch (const InputError& not_to_be_learnt_from) {
    return {executed, 0, true, {}, {}, {rehearsal_on_model(robot, limits, executed)}, {not_to_be_learnt_from.what()}};
  }
}

}  // namespace

FoundRepetition find_repetition(const Parameters& robot, const RunOfMotion& run) {
  if (const auto fault = malformed({run.rows, {}})) throw std::runtime_error(*fault);
  if (run.rows.front().time != 0) throw std::runtime_error("its rows do not begin at 0 s");
  Json plan = json_from_text<Json>(run.plan_json);
  const RepetitionHistory history{motors_began_by(plan), run.refused_fraction};
  const Repetition repetition = next(robot, plan, run, history);
  plan["repetition"] = repetition_json(repetition, {{"motion", run.motion}, {"run", run.run}}, {plan, "plan.json"});
  FoundRepetition found;
  if (const std::vector<std::string> broken = broken_in(repetition); !broken.empty()) {
    found.reason = fmt::format("{}", fmt::join(broken, "; "));
    return found;
  }
  found.plan_json = json_text(plan);
  if (found.plan_json.size() > kLongestPlanJson) {
    plan["repetition"].erase("runs");
    found.plan_json = json_text(plan);
  }
  if (found.plan_json.size() > kLongestPlanJson) {
    throw std::runtime_error(fmt::format("its plan.json would have {} bytes, a reply has room for {}",
                                         found.plan_json.size(), kLongestPlanJson));
  }
  found.status = PlanStatus::kCertified;
  found.rows = repetition.rows.samples;
  const double tolerance = exactness_tolerance(robot);
  found.errors.certified = {tolerance, tolerance};
  found.errors.predicted = repetition.rehearsals.back().link_error;
  return found;
}

}  // namespace fjr
