// plan.json: the promised keys are there, and nothing that JSON cannot say.
#include "planner/results/plan_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/plan.h"
#include "planner/program/summary.h"
#include "planner/results/analysis_json.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Certificate some_certificate() {
  Certificate certificate;
  certificate.certified = true;
  certificate.tolerance = 9.59e-5;
  certificate.open_loop.link = {1e-5, 2e-5};
  certificate.open_loop.motor = {4e-5, 3e-5};
  certificate.open_loop.final_link = {1e-6, 5e-6};
  certificate.open_loop.completed = true;
  certificate.open_loop.stretches = {{0.1, 0.4, 2, "motor 2 rests"}, {0.5, 0.5, 0, "gravity amplifies"}};
  certificate.closed_loop.link = {1e-6, 2e-6};
  certificate.closed_loop.completed = true;
  certificate.closed_loop.feedback_torque = {0.01, 0.002};
  certificate.limits = {
      {.name = "torque", .joint = 1, .limit = 12, .reached = 11.5, .time = 0.1, .rollout = 11.6, .passed = true},
      {.name = "tip_speed", .joint = 0, .limit = kNoLimit, .reached = 2, .time = 0.2, .rollout = 2, .passed = true}};
  return certificate;
}

Analysis some_analysis() {
  Analysis analysis;
  analysis.sensitivity.limits = {{"torque", 1, "N m", 12, 0.0048604512, 0.48, {{0, 0.1}, {0.2, 0.31}}},
                                 {"tip_speed", 0, "m/s", 2.5, 0, 0, {}}};
  analysis.sensitivity.via = {{0.2, {1, 2}, {}, -3.0}};
  analysis.sensitivity.goal = {0.15, 0.02};
  analysis.optimality.hamiltonian = {-0.999, 0.004, 0.04, 0.1, -1, 0.005};
  analysis.optimality.friction_width = 0.003;
  analysis.optimality.costate_end.dtheta = {0.5, 0.25};
  analysis.optimality.along = {{0.05, -1.0, {}}, {0.25, -0.998, {}}};
  analysis.optimality.along[0].costate.theta = {0.3, 0.4};
  analysis.optimality.along[1].costate.theta = {0.5, 0.6};
  return analysis;
}

Plan some_plan() {
  Plan plan;
  plan.status = PlanStatus::kCertified;
  plan.duration = 0.43;
  plan.objective = 0.43;
  plan.terms = {{"time", 0.43}, {"effort", 30.0}};
  plan.intervals = 80;
  plan.method = "hermite-simpson";
  plan.error_estimate = 1e-6;
  plan.node_times = {0, 0.1, 0.43};
  plan.interval_errors = {1e-6, 2.34567e-8};
  plan.iterations = 70;
  plan.cost.factorisations = 75;
  plan.stages = {
      {.name = "friction 0.1 rad/s", .intervals = 40, .iterations = 30, .objective = 0.44, .status = "solved"}};
  plan.starts = 2;
  plan.back_off = 1e-4;
  plan.trajectory = Trajectory{{Sample{}, Sample{.time = 0.43, .state = {}, .torque = {}}}, {}};
  plan.certificate = some_certificate();
  plan.analysis = some_analysis();
  plan.timing = {{"total", 0.1}};
  return plan;
}

Problem some_problem() {
  Problem problem{};
  problem.name = "reach";
  problem.request_hash = "beef";
  return problem;
}

std::vector<std::string> keys(const Json& json) {
  std::vector<std::string> names;
  for (const auto& item : json.items()) names.push_back(item.key());
  return names;
}

TEST(PlanJson, HasEveryPromisedKeyInAFixedOrder) {
  const Json json = plan_json(some_problem(), some_plan());
  EXPECT_THAT(keys(json),
              ElementsAre("version", "request", "status", "reason", "infeasibility", "objective", "duration",
                          "via_times", "mesh", "solver", "warm", "search", "certificate", "sensitivity", "optimality",
                          "resolved_request", "robot", "robot_hash", "request_hash", "back_off", "timing"));
  EXPECT_THAT(keys(json["warm"]), ElementsAre("used", "reason", "from", "away_rad"));
  EXPECT_THAT(keys(json["search"]),
              ElementsAre("cut_by_deadline", "starts", "starts_planned", "minima_refined", "acceleration_penalty"));
  EXPECT_THAT(keys(json["objective"]), ElementsAre("total", "terms"));
  EXPECT_THAT(keys(json["mesh"]), ElementsAre("intervals", "method", "error_estimate", "node_times", "errors"));
  EXPECT_THAT(keys(json["resolved_request"]),
              ElementsAre("start", "goal", "other_goals", "duration", "objective", "via", "task", "limits",
                          "sample_period", "seed", "search", "method", "robust", "proven"));
  EXPECT_THAT(keys(json["solver"]), ElementsAre("iterations", "factorisations", "stages", "starts", "warm",
                                                "cut_by_work", "distinct_minima", "minima", "fallbacks"));
  EXPECT_THAT(keys(json["certificate"]), ElementsAre("verdict", "failures", "tolerance_rad", "open_loop", "closed_loop",
                                                     "limits", "task", "residual", "tracking", "proof", "robustness"));
  EXPECT_THAT(keys(json["certificate"]["limits"][0]),
              ElementsAre("name", "joint", "limit", "reached", "time", "margin", "rollout", "passed"));
}

TEST(PlanJson, SaysWhatThePlanSays) {
  const Json json = plan_json(some_problem(), some_plan());
  EXPECT_EQ(json["status"], "certified");
  EXPECT_EQ(json["request"], "reach");
  EXPECT_TRUE(json["reason"].is_null());
  EXPECT_EQ(json["objective"]["total"], 0.43);
  EXPECT_EQ(json["objective"]["terms"]["effort"], 30.0);
  EXPECT_EQ(json["solver"]["factorisations"], 75);
  EXPECT_EQ(json["solver"]["stages"][0]["iterations"], 30);
  EXPECT_EQ(json["request_hash"], "beef");
  EXPECT_EQ(json["robot_hash"].get<std::string>().size(), 64u);
  EXPECT_EQ(json["timing"]["total"], 0.1);
}

TEST(PlanJson, SaysWhatLimitsWhatAndHowOptimalItIs) {
  const Json json = plan_json(some_problem(), some_plan());
  const Json& sensitivity = json["sensitivity"];
  EXPECT_EQ(
      sensitivity["limits"][0].dump(),
      R"({"name":"torque","joint":1,"limit":12.0,"unit":"N m","worth":0.00486045,"saved_by_1_percent":0.000583254,"active_share":0.48,)"
      R"("active":[[0.0,0.1],[0.2,0.31]]})");
  EXPECT_TRUE(sensitivity["limits"][1]["joint"].is_null());
  EXPECT_TRUE(sensitivity["duration"].is_null());  // free
  EXPECT_EQ(sensitivity["via"].dump(), R"([{"time":0.2,"q":[1.0,2.0],"dq":null,"later":-3.0}])");
  EXPECT_THAT(sensitivity["goal"]["q"], ElementsAre(0.15, 0.02));
  const Json& optimality = json["optimality"];
  EXPECT_THAT(keys(optimality), ElementsAre("hamiltonian", "stationarity", "friction_width", "costate", "along"));
  const Json& along = optimality["along"];
  EXPECT_EQ(along["time"], Json::array({0.05, 0.25}));
  EXPECT_EQ(along["hamiltonian"], Json::array({-1.0, -0.998}));
  EXPECT_EQ(along["costate"]["theta2"], Json::array({0.4, 0.6}));
  EXPECT_EQ(optimality["hamiltonian"].dump(),
            R"({"mean":-0.999,"expected":-1.0,"spread":0.004,"allowed":0.005,"stationary":true,)"
            R"("largest_deviation":0.04,"time":0.1})");
  EXPECT_EQ(optimality["friction_width"], 0.003);
  EXPECT_THAT(keys(optimality["stationarity"]), ElementsAre("where_free", "wrong_sign", "largest", "residual"));
  EXPECT_THAT(optimality["costate"]["end"]["dtheta"], ElementsAre(0.5, 0.25));
  EXPECT_EQ(json["mesh"]["node_times"], Json::array({0, 0.1, 0.43}));
  EXPECT_EQ(json["mesh"]["errors"], Json::array({1e-6, 2.35e-8}));
}

// Of 0.43 s / 0.43 s = 1 the Hamiltonian may vary by `allowed`.
TEST(PlanJson, WhatIsNotStationaryIsToldThereAndInTheSummary) {
  Plan plan = some_plan();
  const Problem problem = some_problem();
  EXPECT_THAT(summary(problem, plan), testing::Not(HasSubstr("stationary")));
  EXPECT_THAT(summary(problem, plan), HasSubstr("  friction    optimised with the law smoothed to 0.003 rad/s"));
  plan.analysis->optimality.hamiltonian.spread = 0.034;
  plan.analysis->optimality.hamiltonian.allowed = 0.02;
  plan.analysis->optimality.friction_width = 0;
  const Json told = plan_json(problem, plan)["optimality"]["hamiltonian"];
  EXPECT_EQ(told["stationary"], false);
  EXPECT_EQ(told["spread"], 0.034);
  EXPECT_EQ(told["allowed"], 0.02);
  EXPECT_THAT(summary(problem, plan),
              HasSubstr("  optimality  not stationary: the Hamiltonian varies by 3.4 % of objective / duration, 2 % at "
                        "most would count as constant"));
  EXPECT_THAT(summary(problem, plan), testing::Not(HasSubstr("friction  ")));
}

TEST(PlanJson, AFineMeshIsToldInAtMostSoManyNumbers) {
  std::vector<double> times(4002), errors(4001, 1e-9);
  for (std::size_t k = 0; k < times.size(); ++k) times[k] = 1e-3 * static_cast<double>(k);
  errors[2999] = 3.14159e-6;
  const auto json = mesh_errors_json(times, errors);
  EXPECT_EQ(json["errors"].size(), 1334u);  // three together
  ASSERT_EQ(json["node_times"].size(), 1335u);
  EXPECT_EQ(json["errors"][999], 3.14e-6);
  EXPECT_EQ(json["node_times"][999], 2.997);
  EXPECT_EQ(json["node_times"].back(), 4.001);
  EXPECT_LE(
      mesh_errors_json({times.begin(), times.begin() + 2001}, {errors.begin(), errors.begin() + 2000}).dump(2).size(),
      50000u);  // a fifth of what plan.json may have in a message
  EXPECT_EQ(mesh_errors_json({}, {})["node_times"].size(), 0u);
}

TEST(PlanJson, CertificateTakesTheLargestErrorOfTheJoints) {
  const Json json = certificate_json(some_certificate());
  EXPECT_EQ(json["verdict"], "certified");
  const Json& open_loop = json["open_loop"];
  EXPECT_EQ(open_loop["max_link_error_rad"], 2e-5);
  EXPECT_EQ(open_loop["max_motor_error_rad"], 4e-5);
  EXPECT_EQ(open_loop["final_link_error_rad"], 5e-6);
  EXPECT_EQ(open_loop["required"], true);
  EXPECT_EQ(open_loop["reason"], "motor 2 rests; gravity amplifies");
  EXPECT_EQ(open_loop["stretches"][0], Json({{"from", 0.1}, {"to", 0.4}, {"joint", 2}, {"reason", "motor 2 rests"}}));
  EXPECT_TRUE(open_loop["stretches"][1]["joint"].is_null());
  EXPECT_EQ(json["closed_loop"]["required"], true);
  EXPECT_TRUE(json["closed_loop"]["perturbed"].is_null());
  EXPECT_THAT(json["closed_loop"]["max_feedback_torque"], ElementsAre(0.01, 0.002));
  EXPECT_EQ(json["limits"][0]["margin"], 0.5);
}

TEST(PlanJson, AProofIsToldWhereItWasAskedFor) {
  Certificate certificate = some_certificate();
  EXPECT_TRUE(certificate_json(certificate)["proof"].is_null());
  EXPECT_THAT(summary(certificate, {}), testing::Not(HasSubstr("proven")));
  certificate.proof.evaluated = true;
  certificate.proof.until = 0.25;
  certificate.proof.reason = "not proven from t = 0.250000 s: open loop: link 1 may be off";
  certificate.proof.open_loop.link = {1e-5, 2e-5};
  certificate.proof.limits = {{"torque", 1, 12, 11.5, {}}, {"tip_speed", 0, 2, 1.5, 1.6}};
  certificate.proof.task = {{"obstacles[0]", 2, "m", 0.011, 0.125, 0.0109}};
  const Json proof = certificate_json(certificate)["proof"];
  EXPECT_EQ(proof["task"][0]["name"], "obstacles[0]");
  EXPECT_EQ(proof["task"][0]["link"], 2);
  EXPECT_EQ(proof["task"][0]["room"], 0.011);
  EXPECT_EQ(proof["task"][0]["time"], 0.125);
  EXPECT_EQ(proof["task"][0]["rollout"], 0.0109);
  const std::string clearance = "obstacles[0] link 2 keeps a clearance of at least 0.011 m";
  EXPECT_THAT(summary(certificate, {}), testing::Not(HasSubstr(clearance)));  // not known beyond 0.25 s
  EXPECT_EQ(proof["verdict"], "not_proven");
  EXPECT_EQ(proof["until"], 0.25);
  EXPECT_EQ(proof["reason"], certificate.proof.reason);
  EXPECT_THAT(proof["open_loop"]["link_error_rad"], ElementsAre(1e-5, 2e-5));
  EXPECT_TRUE(proof["limits"][0]["rollout"].is_null());
  EXPECT_EQ(proof["limits"][1]["rollout"], 1.6);
  EXPECT_TRUE(proof["limits"][1]["joint"].is_null());
  EXPECT_THAT(summary(certificate, {}), HasSubstr("not proven"));
  certificate.proof.proven = true;
  EXPECT_EQ(certificate_json(certificate)["proof"]["verdict"], "proven");
  EXPECT_THAT(summary(certificate, {}), HasSubstr("proven      at all times"));
  EXPECT_THAT(summary(certificate, {}), HasSubstr(clearance));
}

TEST(PlanJson, AFailedCertificateSaysSo) {
  Certificate certificate = some_certificate();
  certificate.certified = false;
  certificate.failures = {"torque 1 exceeds 12 N m"};
  EXPECT_EQ(certificate_json(certificate)["verdict"], "failed");
  EXPECT_THAT(certificate_json(certificate)["failures"], ElementsAre("torque 1 exceeds 12 N m"));
}

TEST(PlanJson, WhatIsNotFiniteIsNull) {
  Plan plan = some_plan();
  plan.objective = kNaN;
  plan.terms["time"] = kNoLimit;
  plan.stages[0].objective = -kNoLimit;
  plan.certificate->open_loop.link = {kNoLimit, 0};
  const Json json = Json::parse(json_text(plan_json(some_problem(), plan)));
  EXPECT_TRUE(json["objective"]["total"].is_null());
  EXPECT_TRUE(json["objective"]["terms"]["time"].is_null());
  EXPECT_TRUE(json["solver"]["stages"][0]["objective"].is_null());
  EXPECT_TRUE(json["certificate"]["open_loop"]["max_link_error_rad"].is_null());
  EXPECT_TRUE(json["certificate"]["limits"][1]["limit"].is_null());
  EXPECT_TRUE(json["certificate"]["limits"][1]["joint"].is_null());
}

TEST(PlanJson, WithoutATrajectoryThereIsNoDuration) {
  Plan plan;
  plan.status = PlanStatus::kInfeasible;
  plan.reason = "torque 1 reaches its limit";
  const Json json = plan_json(some_problem(), plan);
  EXPECT_EQ(json["status"], "infeasible");
  EXPECT_EQ(json["reason"], "torque 1 reaches its limit");
  EXPECT_TRUE(json["duration"].is_null());
  EXPECT_TRUE(json["objective"]["total"].is_null());
  EXPECT_TRUE(json["certificate"].is_null());
  EXPECT_TRUE(json["sensitivity"].is_null());
  EXPECT_TRUE(json["optimality"].is_null());
  EXPECT_TRUE(json["mesh"]["errors"].empty());
}

TEST(PlanJson, RefusalsHaveTheSameFirstKeys) {
  const Json json = bad_input_json("reach", "reach.yaml: goal.q[1]: 9 rad is outside [-2.6, 2.6]", "goal.q[1]");
  EXPECT_THAT(keys(json), ElementsAre("version", "request", "status", "reason", "field"));
  EXPECT_EQ(json["status"], "bad_input");
  EXPECT_EQ(json["field"], "goal.q[1]");
  EXPECT_TRUE(bad_input_json("reach", "reach.yaml: no such file", "")["field"].is_null());
}

TEST(PlanJson, TextIsTheSameEveryTimeAndSurvivesAnyBytes) {
  Plan plan = some_plan();
  plan.reason = "caf\xe9 \x01 \"quoted\"";
  const std::string text = json_text(plan_json(some_problem(), plan));
  EXPECT_EQ(text, json_text(plan_json(some_problem(), plan)));
  EXPECT_EQ(text.back(), '\n');
  EXPECT_EQ(Json::parse(text)["reason"], "caf\xEF\xBF\xBD \x01 \"quoted\"");
}

TEST(PlanJson, NumbersReadBackToTheSameBits) {
  Plan plan = some_plan();
  plan.duration = 0.1 + 0.2;
  EXPECT_EQ(Json::parse(json_text(plan_json(some_problem(), plan)))["duration"].get<double>(), 0.1 + 0.2);
}

struct Row {
  PlanStatus status;
  const char* name;
  int exit_code;
};

TEST(PlanStatus, NamesAndExitCodesAreAsDocumented) {
  const Row rows[] = {{PlanStatus::kCertified, "certified", 0},     {PlanStatus::kBadInput, "bad_input", 2},
                      {PlanStatus::kInfeasible, "infeasible", 3},   {PlanStatus::kNotConverged, "not_converged", 3},
                      {PlanStatus::kUncertified, "uncertified", 4}, {PlanStatus::kDeadline, "deadline", 5},
                      {PlanStatus::kCancelled, "cancelled", 5}};
  for (const Row& row : rows) {
    EXPECT_STREQ(name(row.status), row.name);
    EXPECT_EQ(exit_code(row.status), row.exit_code) << row.name;
  }
}

}  // namespace
}  // namespace fjr
