#include "planner/results/repetition_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/bounded_json.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRuns = 20;
constexpr double kMostRepetitions = 1e9;

Json rehearsal_json(const Rehearsal& rehearsal) {
  Json json{{"arm", rehearsal.arm},
            {"link_error_rad", rehearsal.link_error},
            {"link_error_rms_rad", rehearsal.link_error_rms},
            {"limits", Json::array()},
            {"task", Json::array()},
            {"broken", rehearsal.broken}};
  for (const LimitCheck& check : rehearsal.limits) json["limits"].push_back(limit_json(check));
  for (const TaskCheck& check : rehearsal.task) json["task"].push_back(task_json(check));
  return json;
}

// Returns the earlier runs; none if the plan.json is of an earlier version.
std::vector<JsonField> runs_before(const JsonField& plan) {
  const auto repetition = plan.find("repetition");
  const auto runs = repetition ? repetition->find("runs") : std::nullopt;
  return runs ? runs->items() : std::vector<JsonField>{};
}

Joints<double> finite_pair(const JsonField& field) {
  const Joints<double> values = field.pair();
  if (!std::isfinite(values[0] + values[1])) field.fail("must be a list of two numbers");
  return values;
}

int number_in(const JsonField& field) {
  const double value = field.number();
  if (!(value >= 1 && value <= kMostRepetitions && value == std::floor(value))) {
    field.fail(fmt::format("must be an integer from 1 to {:.0f}", kMostRepetitions));
  }
  return static_cast<int>(value);
}

// Returns the number of the repetition to which the rows belong; 1 is the motion as planned.
int number_of(const JsonField& plan) {
  const auto repetition = plan.find("repetition");
  return repetition ? number_in(repetition->at("number")) : 1;
}

// Returns all runs so far, with the last one at the end.
Json runs_so_far(const Repetition& repetition, const JsonField& plan) {
  Json runs = Json::array();
  for (const JsonField& run : runs_before(plan)) runs.push_back(run.json());
  if (repetition.link_error_rms != Joints<double>{}) {
    runs.push_back({{"number", number_of(plan)},
                    {"link_error_rms_rad", repetition.link_error_rms},
                    {"motors_began_rad", repetition.motors_began}});
  }
  while (runs.size() > kMostRuns) runs.erase(runs.begin());
  return runs;
}

}  // namespace

Json repetition_json(const Repetition& repetition, const Json& run, const JsonField& plan) {
  Json json{{"number", number_of(plan) + 1}};
  json.update(run);
  json["refused"] = repetition.refused;
  json["fraction"] = repetition.fraction;
  json["reasons"] = repetition.reasons;
  json["last_link_error_rms_rad"] =
      repetition.link_error_rms == Joints<double>{} ? Json(nullptr) : Json(repetition.link_error_rms);
  json["runs"] = runs_so_far(repetition, plan);
  json["rehearsals"] = Json::array();
  for (const Rehearsal& rehearsal : repetition.rehearsals) json["rehearsals"].push_back(rehearsal_json(rehearsal));
  return json;
}

std::optional<Joints<double>> motors_began_before(const JsonField& plan) {
  std::optional<Joints<double>> began;
  for (const JsonField& run : runs_before(plan)) {
    (void)number_in(run.at("number"));
    (void)finite_pair(run.at("link_error_rms_rad"));
    began = finite_pair(run.at("motors_began_rad"));
  }
  return began;
}

std::optional<TakenCorrection> correction_in(const std::string& plan_json) {
  const Json plan = json_from_text<Json>(plan_json);
  if (!plan.is_object() || !plan.contains("repetition")) return std::nullopt;
  try {
    const JsonField repetition = JsonField(plan, "plan.json").at("repetition");
    const TakenCorrection taken{repetition.at("run").text(), repetition.at("fraction").number()};
    return taken.fraction > 0 && taken.fraction <= 1 ? std::optional(taken) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void tell_repetition(const Json& plan, Metadata& metadata) {
  if (!plan.contains("repetition")) return;
  metadata["status"] = kLearntStatus;
  metadata["repetition"] = std::to_string(number_of({plan, "plan.json"}));
}

}  // namespace fjr
