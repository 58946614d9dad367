#include "planner/results/repetition_json.h"

#include <nlohmann/json.hpp>
#include <string>

#include "planner/results/plan_json.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

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

}  // namespace

Json repetition_json(const Repetition& repetition, const Json& run, int number) {
  Json json{{"number", number}};
  json.update(run);
  json["refused"] = repetition.refused;
  json["fraction"] = repetition.fraction;
  json["reasons"] = repetition.reasons;
  json["last_link_error_rms_rad"] =
      repetition.link_error_rms == Joints<double>{} ? Json(nullptr) : Json(repetition.link_error_rms);
  json["rehearsals"] = Json::array();
  for (const Rehearsal& rehearsal : repetition.rehearsals) json["rehearsals"].push_back(rehearsal_json(rehearsal));
  return json;
}

int number_of_repetition(const Json& plan) {
  const auto repetition = plan.find("repetition");
  return repetition == plan.end() ? 1 : repetition->at("number").get<int>();
}

void tell_repetition(const Json& plan, Metadata& metadata) {
  if (!plan.contains("repetition")) return;
  metadata["status"] = "learnt";
  metadata["repetition"] = std::to_string(number_of_repetition(plan));
}

}  // namespace fjr
