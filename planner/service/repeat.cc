#include "planner/service/repeat.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "common/input_error.h"
#include "planner/certificate/consistency.h"
#include "planner/learning/repetition.h"
#include "planner/results/plan_json.h"
#include "planner/results/planned_with.h"
#include "planner/results/repetition_json.h"
#include "planner/results/verification.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

// As the executor's own log file has it.
Log log_of(const RunOfMotion& run) {
  Log log;
  log.source = "the run " + run.run;
  log.metadata["missed_ticks"] = std::to_string(run.missed_ticks);
  const auto add = [&](std::string name, const auto& value_in) {
    log.names.push_back(std::move(name));
    std::vector<double>& values = log.values.emplace_back();
    for (const ExecutedRow& tick : run.ticks) values.push_back(value_in(tick));
  };
  add("time", [](const ExecutedRow& tick) { return tick.time; });
  for (std::size_t j = 0; j < kJoints; ++j) {
    const int joint = static_cast<int>(j);
    add(joint_column("q", joint), [j](const ExecutedRow& tick) { return tick.q[j]; });
    add(joint_column("theta", joint), [j](const ExecutedRow& tick) { return tick.theta[j]; });
    add(joint_column("tau", joint), [j](const ExecutedRow& tick) { return tick.torque[j]; });
    add(joint_column("q", joint, "_plan"), [j](const ExecutedRow& tick) { return tick.planned_q[j]; });
    add(joint_column("theta", joint, "_plan"), [j](const ExecutedRow& tick) { return tick.planned_theta[j]; });
  }
  return log;
}

Limits limits_of_plan(const Parameters& robot, const Json& plan) {
  Metadata header;
  tell_planned_with(plan, header);
  return limits_of(robot, planned_with(header, "plan.json"));
}

Repetition next(const Parameters& robot, const Json& plan, const RunOfMotion& run) {
  const Trajectory executed{run.rows, {}};
  const PlannedTask planned = planned_task_in(run.plan_json, "plan.json");
  const TaskOfMotion task = TaskOfMotion::of(robot, planned.task, planned.ends);
  try {
    const Log log = log_of(run);
    require_run_of(executed, "the trajectory", log);
    return next_repetition(robot, limits_of_plan(robot, plan), task, executed, executed_motion(log));
  } catch (const InputError& not_to_be_learnt_from) {
    return {executed, 0, true, {}, {}, {not_to_be_learnt_from.what()}};
  }
}

std::string what_is_broken(const Repetition& repetition) {
  std::vector<std::string> sentences;
  std::set<std::string> told;
  for (const Rehearsal& rehearsal : repetition.rehearsals) {
    for (const std::string& broken : rehearsal.broken) {
      if (told.insert(broken).second) sentences.push_back(rehearsal.arm + ": " + broken);
    }
  }
  return fmt::format("{}", fmt::join(sentences, "; "));
}

}  // namespace

Repeated repeat(const Parameters& robot, const RunOfMotion& run) {
  if (const std::string fault = malformed({run.rows, {}}); !fault.empty()) throw std::runtime_error(fault);
  if (run.rows.front().time != 0) throw std::runtime_error("its rows do not begin at 0 s");
  Json plan = Json::parse(run.plan_json);
  const Repetition repetition = next(robot, plan, run);
  plan["repetition"] =
      repetition_json(repetition, {{"motion", run.motion}, {"run", run.run}}, number_of_repetition(plan) + 1);
  Repeated repeated;
  if (!may_be_executed(repetition)) {
    repeated.reason = what_is_broken(repetition);
    return repeated;
  }
  repeated.plan_json = json_text(plan);
  if (repeated.plan_json.size() > kLongestPlanJson) {
    throw std::runtime_error(fmt::format("its plan.json would have {} bytes, a reply has room for {}",
                                         repeated.plan_json.size(), kLongestPlanJson));
  }
  repeated.status = PlanStatus::kCertified;
  repeated.rows = repetition.rows.samples;
  const double tolerance = exactness_tolerance(robot);
  repeated.errors.certified = {tolerance, tolerance};
  if (!repetition.rehearsals.empty()) repeated.errors.predicted = repetition.rehearsals.back().link_error;
  return repeated;
}

}  // namespace fjr
