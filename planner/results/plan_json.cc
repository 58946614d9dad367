#include "planner/results/plan_json.h"

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planner/problem/task/task.h"
#include "planner/request/problem_settings.h"
#include "planner/request/words.h"
#include "planner/results/analysis_json.h"
#include "planner/search/settings_fields.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json numbers(const Joints<double>& values) { return Json::array({number(values[0]), number(values[1])}); }
Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }
Json text_or_null(const std::optional<std::string>& text) { return text ? Json(*text) : Json(nullptr); }

Json list_of(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

Json numbers(const std::map<std::string, double>& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values) json[name] = number(value);
  return json;
}

Json rollout_json(const RolloutErrors& errors, const std::string& reason) {
  return {{"max_link_error_rad", number(errors.max_link())},
          {"max_motor_error_rad", number(errors.max_motor())},
          {"final_link_error_rad", number(errors.max_final_link())},
          {"time_of_max_link_error", number(errors.time_of_max_link)},
          {"required", true},
          {"reason", text_or_null(reason)},
          {"completed", errors.completed},
          {"failure", text_or_null(errors.failure)}};
}

Json open_loop_json(const OpenLoop& open_loop) {
  Json json = rollout_json(open_loop, open_loop.why_not_in_one_run());
  json["stretches"] = Json::array();
  for (const Stretch& stretch : open_loop.stretches) {
    json["stretches"].push_back({{"from", number(stretch.from)},
                                 {"to", number(stretch.to)},
                                 {"joint", joint_or_null(stretch.joint)},
                                 {"reason", stretch.why}});
  }
  return json;
}

Json closed_loop_json(const ClosedLoop& closed_loop) {
  Json json = rollout_json(closed_loop, "");
  json["max_feedback_torque"] = numbers(closed_loop.feedback_torque);
  const Perturbed& perturbed = closed_loop.perturbed;
  json["perturbed"] = perturbed.evaluated ? Json{{"link_error_rad", numbers(perturbed.link)},
                                                 {"time_of_max_link_error", number(perturbed.time_of_max_link)},
                                                 {"link_error_after_rad", numbers(perturbed.after)}}
                                          : Json(nullptr);
  return json;
}

Json proven_loop_json(const Proof::Loop& loop) {
  return {{"proven", loop.proven},
          {"until", number(loop.until)},
          {"reason", text_or_null(loop.reason)},
          {"link_error_rad", numbers(loop.link)},
          {"time_of_max_link_error", number(loop.time_of_max_link)},
          {"uncertainty_rad", number(loop.width)},
          {"steps", loop.steps}};
}

Json proof_json(const Proof& proof) {
  if (!proof.evaluated) return nullptr;
  Json limits = Json::array();
  for (const LimitBound& bound : proof.limits) {
    limits.push_back({{"name", bound.name},
                      {"joint", joint_or_null(bound.joint)},
                      {"allowed", number(bound.allowed)},
                      {"published", number(bound.published)},
                      {"rollout", bound.rollout ? number(*bound.rollout) : Json(nullptr)}});
  }
  Json task = Json::array();
  for (const TaskBound& bound : proof.task) {
    task.push_back({{"name", bound.name},
                    {"link", joint_or_null(bound.link)},
                    {"unit", bound.unit},
                    {"room", number(bound.published)},
                    {"time", number(bound.time)},
                    {"rollout", number(bound.rollout)}});
  }
  Json closed_loop = proven_loop_json(proof.closed_loop);
  closed_loop["link_velocity_error"] = numbers(proof.closed_loop.link_velocity);
  closed_loop["motor_velocity_error"] = numbers(proof.closed_loop.motor_velocity);
  closed_loop["feedback_torque"] = numbers(proof.closed_loop.feedback_torque);
  return {{"verdict", proof.proven ? "proven" : "not_proven"},
          {"until", number(proof.until)},
          {"reason", text_or_null(proof.reason)},
          {"open_loop", proven_loop_json(proof.open_loop)},
          {"closed_loop", std::move(closed_loop)},
          {"limits", std::move(limits)},
          {"task", std::move(task)}};
}

Json margins_json(const std::vector<Robustness::Margin>& margins, const char* whose) {
  Json list = Json::array();
  for (const Robustness::Margin& m : margins) {
    Json json{{"name", m.name}, {whose, joint_or_null(m.joint)}, {"unit", m.unit}};
    if (std::isfinite(m.limit)) json["limit"] = m.limit;
    json.update({{"factor", number(m.factor)},
                 {"needed", number(m.needed)},
                 {"there", number(m.there)},
                 {"time", number(m.time)},
                 {"parameter", text_or_null(m.parameter)},
                 {"fraction", number(m.fraction)},
                 {"passed", m.passed},
                 {"tube", list_of(m.tube)}});
    list.push_back(std::move(json));
  }
  return list;
}

Json fractions_json(const std::vector<std::pair<std::string, double>>& of, const char* what) {
  Json list = Json::array();
  for (const auto& [parameter, value] : of) list.push_back({{"parameter", parameter}, {what, number(value)}});
  return list;
}

Json robustness_json(const Robustness& r, double count) {
  if (!r.evaluated) return nullptr;
  Json link_tubes = Json::array();
  for (const std::vector<double>& tube : r.link_tube) link_tubes.push_back(list_of(tube));
  return {{"verdict", r.kept ? "kept" : "lacking"},
          {"reason", text_or_null(r.reason)},
          {"confidence", number(r.confidence)},
          {"certainty", number(r.certainty)},
          {"arms", r.arms},
          {"parameters", r.parameters},
          {"directions", r.directions},
          {"first_order_factor", number(r.first_order)},
          {"ellipsoid_factor", number(r.ellipsoid)},
          {"link_error_rad", numbers(r.link)},
          {"link_error_counts", numbers(Joints<double>{r.link[0] / count, r.link[1] / count})},
          {"limits", margins_json(r.limits, "joint")},
          {"task", margins_json(r.task, "link")},
          {"costs", fractions_json(r.costs, "fraction")},
          {"price", r.price ? number(*r.price) : Json(nullptr)},
          {"saved_by_halved_error", fractions_json(r.savings, "objective")},
          {"times", list_of(r.times)},
          {"link_tubes_rad", std::move(link_tubes)},
          {"not_covered", Robustness::kNotCovered}};
}

Json residual_json(const Residual& residual) {
  if (!residual.evaluated) return nullptr;
  return {{"window", number(residual.window)},
          {"link_vibration_rad", numbers(residual.link_vibration)},
          {"open_loop_drift_rad", numbers(residual.open_loop_drift)}};
}

Json tracking_json(const Tracking& tracking) {
  return {{"link_error_rad", numbers(tracking.link_error)},
          {"link_error_rms_rad", numbers(tracking.link_error_rms)},
          {"feedback_torque", numbers(tracking.feedback_torque)},
          {"peak_torque", numbers(tracking.peak_torque)},
          {"saturated", tracking.saturated}};
}

Json solver_json(const Plan& plan) {
  Json stages = Json::array();
  for (const SolverStage& stage : plan.stages) {
    stages.push_back({{"name", stage.name},
                      {"intervals", stage.intervals},
                      {"iterations", stage.iterations},
                      {"objective", number(stage.objective)},
                      {"status", stage.status}});
  }
  Json fallbacks = Json::object();
  visit_fallbacks(plan.fallbacks, [&](const char* name, int count) { fallbacks[name] = count; });
  Json minima = Json::array();
  for (const double objective : plan.minima) minima.push_back(number(objective));
  return {{"iterations", plan.iterations},
          {"factorisations", plan.cost.factorisations},
          {"stages", std::move(stages)},
          {"starts", plan.starts},
          {"warm", plan.warm},
          {"cut_by_work", plan.cut_by_work},
          {"distinct_minima", plan.minima.size()},
          {"minima", std::move(minima)},
          {"fallbacks", std::move(fallbacks)}};
}

Json warm_json(const Plan& plan) {
  return {{"used", plan.warm},
          {"reason", text_or_null(plan.warm_refusal)},
          {"from", text_or_null(plan.warm_name)},
          {"away_rad", plan.warm_away ? Json(*plan.warm_away) : Json(nullptr)}};
}

Json search_json(const Plan& plan) {
  return {{"cut_by_deadline", plan.cut_by_deadline},
          {"starts", plan.starts},
          {"starts_planned", plan.starts_planned},
          {"minima_refined", plan.refined},
          {"acceleration_penalty", number(plan.acceleration_penalty)}};
}

Json time_or_null(const std::optional<double>& time) { return time ? number(*time) : Json(nullptr); }

Json infeasibility_json(const Infeasibility& why) {
  Json relaxations = Json::array();
  for (const Relaxation& r : why.relaxations) {
    relaxations.push_back({{"name", r.name},
                           {"joint", joint_or_null(r.joint)},
                           {"unit", r.unit},
                           {"from", number(r.from)},
                           {"to", number(r.to)},
                           {"rough", r.rough},
                           {"within_robot", r.within_robot},
                           {"time", time_or_null(r.time)}});
  }
  return {{"limit", text_or_null(why.limit)},
          {"joint", joint_or_null(why.joint)},
          {"time", time_or_null(why.time)},
          {"relaxations", std::move(relaxations)},
          {"shortest_duration", time_or_null(why.shortest_duration)}};
}

Json mesh_json(const Plan& plan) {
  const bool moves = plan.trajectory.has_value();
  Json json{{"intervals", plan.intervals},
            {"method", text_or_null(plan.method)},
            {"error_estimate", moves ? number(plan.error_estimate) : Json(nullptr)}};
  json.update(moves ? mesh_errors_json(plan.node_times, plan.interval_errors) : mesh_errors_json({}, {}));
  return json;
}

Json state_json(const State<double>& state, bool at_rest) {
  return {{"q", numbers(state.q)},
          {"dq", numbers(state.dq)},
          {"theta", numbers(state.theta)},
          {"dtheta", numbers(state.dtheta)},
          {"at_rest", at_rest}};
}

Json numbers_or_null(const std::optional<Joints<double>>& values) { return values ? numbers(*values) : Json(nullptr); }

Json goal_json(const Goal& goal) {
  Json q = numbers(goal.q);
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (goal.free[j]) q[j] = nullptr;
  }
  return {{"q", std::move(q)},
          {"dq", numbers(goal.dq)},
          {"theta", numbers_or_null(goal.theta)},
          {"dtheta", numbers_or_null(goal.dtheta)},
          {"dq_free", goal.dq_free},
          {"at_rest", goal.at_rest}};
}

Json via_json(const std::vector<Via>& vias) {
  Json list = Json::array();
  for (const Via& via : vias) {
    list.push_back({{"time", via.time ? number(*via.time) : Json(nullptr)},
                    {"q", numbers(via.q)},
                    {"dq", numbers_or_null(via.dq)},
                    {"tolerance", via.tolerance}});
  }
  return list;
}

Json limits_json(const Limits& limits) {
  Json json = Json::object();
  for (const QuantityInfo& quantity : Quantities::infos) {
    if (!is_limited(quantity, limits)) continue;
    if (quantity.of_tip) json[quantity.name] = limits.*quantity.of_tip;
    if (quantity.per_joint) json[quantity.name] = numbers(limits.*quantity.per_joint);
  }
  return json;
}

Json json_of(double value) { return value; }
Json json_of(const Joints<double>& value) { return numbers(value); }
Json json_of(const std::vector<Joints<double>>& values) {
  Json list = Json::array();
  for (const Joints<double>& value : values) list.push_back(numbers(value));
  return list;
}
Json json_of(ArcWay way) { return way == ArcWay::kLong ? Json("long") : Json(nullptr); }
Json json_of(const TipBox& box) { return {numbers(box.lower), numbers(box.upper)}; }

template <class Constraint>
Json json_of(const Constraint& constraint) {
  Json json = Json::object();
  visit(constraint, [&](const Key& key, const auto& member) {
    const Json value = json_of(member);
    if (!value.is_null()) json[key.name] = value;
  });
  return json;
}

// What there is to draw beside the arm.
Json task_json(const Task& task) {
  Json json = Json::object();
  visit_constraints(task, [&](const char* key, const auto& member) {
    if constexpr (requires { member.size(); }) {
      for (const auto& constraint : member) json[key].push_back(json_of(constraint));
    } else if (member) {
      json[key] = json_of(*member);
    }
  });
  return json;
}

template <class Value>
Json setting_json(const Value& value) {
  return value;
}
Json setting_json(Thoroughness search) { return word_of(search); }
Json setting_json(const std::optional<double>& confidence) {
  return confidence ? Json{{"confidence", *confidence}} : Json(nullptr);
}

Json robot_json(const Parameters& robot) {
  Json json = Json::object();
  visit_parameters(robot, [&](const char* section, const char* name, const char*, const Joints<double>& values) {
    json[section][name] = numbers(values);
  });
  json["mounting"] = {{"gravity", robot.mounting.gravity}, {"down", robot.mounting.down}};
  json["payload"] = {{"mass", robot.payload.mass}, {"inertia", robot.payload.inertia}};
  return json;
}

Json json_of_setting(double value) { return number(value); }
template <std::integral Whole>
Json json_of_setting(Whole value) {
  return value;
}
template <SettingList List>
Json json_of_setting(const List& values) {
  Json list = Json::array();
  for (const auto value : values) list.push_back(json_of_setting(value));
  return list;
}

// All settings with their keys, in the order of visit_all_settings().
std::vector<std::pair<std::string, Json>> keyed_settings(const SearchSettings& settings) {
  std::vector<std::pair<std::string, Json>> all;
  visit_all_settings(settings, [&](const std::string& path, const SettingKey&, const auto& value) {
    all.emplace_back(path, json_of_setting(value));
  });
  return all;
}

Json head(PlanStatus status, const std::string& reason, const std::string& request) {
  return {{"version", FJR_VERSION}, {"request", request}, {"status", name(status)}, {"reason", text_or_null(reason)}};
}

}  // namespace

Json limit_json(const LimitCheck& check) {
  return {{"name", check.name},
          {"joint", joint_or_null(check.joint)},
          {"limit", number(check.limit)},
          {"reached", number(check.reached)},
          {"time", number(check.time)},
          {"margin", number(check.margin())},
          {"rollout", number(check.rollout)},
          {"passed", check.passed}};
}

Json task_json(const TaskCheck& check) {
  return {{"name", check.name}, {"link", joint_or_null(check.link)}, {"room", number(check.clearance)},
          {"unit", check.unit}, {"time", number(check.time)},        {"passed", check.passed}};
}

Json settings_json(const SearchSettings& settings) {
  const auto all = keyed_settings(settings), defaults = keyed_settings({});
  Json changed = Json::object();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].second != defaults[i].second) changed[all[i].first] = all[i].second;
  }
  return changed;
}

Json resolved_request_json(const Problem& problem) {
  Json weights = Json::object();
  for (const TermInfo& term : Terms::infos) {
    const double weight = problem.weights.*term.weight;
    if (weight != 0 || term.of_first_version) weights[std::string(term.name)] = number(weight);
  }
  Json others = Json::array();
  for (const Goal& goal : problem.other_goals) others.push_back(goal_json(goal));
  Json json{{"start", state_json(problem.start, problem.start_at_rest)},
            {"goal", goal_json(problem.goal)},
            {"other_goals", std::move(others)},
            {"duration", {{"min", problem.duration.min}, {"max", problem.duration.max}}},
            {"objective", std::move(weights)},
            {"via", via_json(problem.via)},
            {"task", task_json(problem.task)},
            {"limits", limits_json(problem.limits)}};
  visit_settings(problem, [&](const char* key, const auto& value, bool) { json[key] = setting_json(value); });
  return json;
}

Json certificate_json(const Certificate& certificate) {
  Json limits = Json::array();
  for (const LimitCheck& check : certificate.limits) limits.push_back(limit_json(check));
  Json task = Json::array();
  for (const TaskCheck& check : certificate.task) task.push_back(task_json(check));
  return {{"verdict", certificate.certified ? "certified" : "failed"},
          {"failures", certificate.failures},
          {"tolerance_rad", number(certificate.tolerance)},
          {"open_loop", open_loop_json(certificate.open_loop)},
          {"closed_loop", closed_loop_json(certificate.closed_loop)},
          {"limits", std::move(limits)},
          {"task", std::move(task)},
          {"residual", residual_json(certificate.residual)},
          {"tracking", tracking_json(certificate.tracking)},
          {"proof", proof_json(certificate.proof)},
          {"robustness", robustness_json(certificate.robustness, certificate.tolerance)}};
}

Json plan_json(const Problem& problem, const Plan& plan) {
  const bool moves = plan.trajectory.has_value();
  Json json = head(plan.status, plan.reason, problem.name);
  json["infeasibility"] = plan.infeasibility ? infeasibility_json(*plan.infeasibility) : Json(nullptr);
  json["objective"] = {{"total", moves ? number(plan.objective) : Json(nullptr)},
                       {"terms", moves ? numbers(plan.terms) : Json::object()}};
  json["duration"] = moves ? number(plan.duration) : Json(nullptr);
  json["via_times"] = plan.via_times;
  json["mesh"] = mesh_json(plan);
  json["solver"] = solver_json(plan);
  json["warm"] = warm_json(plan);
  json["search"] = search_json(plan);
  if (Json settings = settings_json(plan.settings); !settings.empty()) json["settings"] = std::move(settings);
  json["certificate"] = plan.certificate ? certificate_json(*plan.certificate) : Json(nullptr);
  json["sensitivity"] = plan.analysis ? sensitivity_json(plan.analysis->sensitivity) : Json(nullptr);
  json["optimality"] = plan.analysis ? optimality_json(plan.analysis->optimality) : Json(nullptr);
  json["resolved_request"] = resolved_request_json(problem);
  json["robot"] = robot_json(problem.robot);
  json["robot_hash"] = robot_hash(problem.robot);
  json["request_hash"] = problem.request_hash;
  json["back_off"] = number(plan.back_off);
  json["timing"] = numbers(plan.timing);
  return json;
}

Json bad_input_json(const std::string& name, const std::string& reason, const std::string& field) {
  Json json = head(PlanStatus::kBadInput, reason, name);
  json["field"] = text_or_null(field);
  return json;
}

std::string json_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace fjr
