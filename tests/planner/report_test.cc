// The report: the physics of what a plan is compared with, what the page holds, and folders that are no plans.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <string>

#include "common/chart_page.h"
#include "common/input_error.h"
#include "model/kinematics.h"
#include "planner/ocp/objective.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/results/plan_json.h"
#include "planner/results/report/both_plans_page.h"
#include "planner/results/report/plan_page.h"
#include "planner/results/report/rigid_profile.h"
#include "planner/results/report/scene.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const fs::path kRobot = fs::path(FJR_SOURCE_DIR) / "config" / "robot.yaml";

// ---- profiles ----

class Profiles : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(, Profiles, testing::Values(Profile::kMinimumJerk, Profile::kTrapezoidal),
                         [](const auto& profile) {
                           return profile.param == Profile::kMinimumJerk ? "minimum_jerk" : "trapezoidal";
                         });

TEST_P(Profiles, LeadFromRestToRestAndAreTheirOwnDerivatives) {
  EXPECT_EQ(along(GetParam(), 0).position, 0);
  EXPECT_NEAR(along(GetParam(), 1).position, 1, 1e-15);
  EXPECT_EQ(along(GetParam(), 0).velocity, 0);
  EXPECT_NEAR(along(GetParam(), 1).velocity, 0, 1e-14);
  for (const double corner : {1.0 / 3, 2.0 / 3}) {  // of the trapezoid
    const Along before = along(GetParam(), corner - 1e-12), after = along(GetParam(), corner + 1e-12);
    EXPECT_NEAR(before.position, after.position, 1e-10);
    EXPECT_NEAR(before.velocity, after.velocity, 1e-10);
  }
  constexpr double kStep = 1e-5;
  for (double c = 0.01; c < 1; c += 0.0123) {  // never within a step of a jump
    const Along before = along(GetParam(), c - kStep), at = along(GetParam(), c), after = along(GetParam(), c + kStep);
    // Central differences: error kStep^2 / 6 times a third derivative of at most 360.
    EXPECT_NEAR((after.position - before.position) / (2 * kStep), at.velocity, 1e-8) << c;
    EXPECT_NEAR((after.velocity - before.velocity) / (2 * kStep), at.acceleration, 1e-7) << c;
  }
}

// With springs a hundred times as stiff the arm is nearly rigid, and the rigid arm's torque nearly exact: what is left
// after the end falls as the stiffness grows, acceleration / frequency^2. (Much stiffer ones the executor's feedback
// from the links, which goes by the spring, cannot hold with its ticks.)
TEST_P(Profiles, LeaveNoResidualOnAStiffArm) {
  const Joints<double> from{0.2, -0.3}, to{1.0, 0.5};
  const auto stiffened = [](double times) {
    Parameters robot = load_parameters(kRobot);
    for (double& stiffness : robot.spring.stiffness) stiffness *= times;
    return robot;
  };
  const auto reference_of = [&](double times) { return rigid_reference(stiffened(times), GetParam(), from, to, 0.8); };
  const auto run_with = [&](double times) { return run_on_elastic_arm(stiffened(times), reference_of(times)); };
  const ElasticRun soft = run_with(1), less_stiff = run_with(30), stiff = run_with(100);
  const Trajectory reference = reference_of(100);
  ASSERT_EQ(stiff.simulation.failure, "");
  double feed_forward = 0;
  for (const Sample& row : reference.samples) feed_forward = std::max(feed_forward, std::abs(row.torque[0]));
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_LT(stiff.figures.residual[j], 1e-3) << j;                              // measured: 7e-4 and less
    EXPECT_GT(soft.figures.residual[j], 50 * stiff.figures.residual[j]) << j;     // measured: 126 and more
    EXPECT_LT(stiff.figures.residual[j], 0.45 * less_stiff.figures.residual[j]);  // 0.3 by the law
  }
  EXPECT_EQ(stiff.figures.settling_time, 0);
  EXPECT_NEAR(stiff.figures.peaks.torque[0], feed_forward,
              0.05 * feed_forward);  // the feedback has next to nothing to do
}

// Motors that follow perfectly shake the links by s(t) alone. Linearised at the goal, every mode is an oscillator whose
// amplitude after the end is the Fourier transform of s'' at its frequency; computed here from the eigenvalues of the
// paper's matrices, with no integrator.
TEST_P(Profiles, ResidualIsThatOfTheLinearisedArm) {
  Parameters robot = load_parameters(kRobot);
  robot.motor.inertia = {1e5, 1e5};  // which no spring moves, and no encoder has to tell
  robot.drive.peak_torque = {1e9, 1e9};
  const Joints<double> from{-0.04, 0.03}, to{0.03, -0.03};
  constexpr double kDuration = 0.3;

  const MassMatrix<double> m = mass_matrix(robot, to[1]);
  Eigen::Matrix2d mass, stiffness;
  mass << m.m11, m.m12, m.m12, m.m22;
  const double second = robot.link.gravity_torque[1] * std::cos(to[0] + to[1]);  // dG/dq
  stiffness << robot.spring.stiffness[0] + robot.link.gravity_torque[0] * std::cos(to[0]) + second, second, second,
      robot.spring.stiffness[1] + second;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> modes(stiffness, mass);
  Eigen::Vector2d pull;  // K (theta at the end - theta at the start)
  for (std::size_t j = 0; j < kJoints; ++j) {
    pull[static_cast<Eigen::Index>(j)] =
        robot.spring.stiffness[j] * (rest_at(robot, to).theta[j] - rest_at(robot, from).theta[j]);
  }
  std::array<std::complex<double>, 2> amplitude;
  for (int i = 0; i < 2; ++i) {
    const double frequency = std::sqrt(modes.eigenvalues()[i]);
    constexpr int kSteps = 30000;
    std::complex<double> transform = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double c = (k + 0.5) / kSteps;
      transform +=
          along(GetParam(), c).acceleration * std::polar(1.0, -frequency * kDuration * c) / (kDuration * kSteps);
    }
    amplitude[static_cast<std::size_t>(i)] =
        -modes.eigenvectors().col(i).dot(pull) * transform / std::pow(frequency, 3);
  }
  Joints<double> expected{};
  for (double t = kDuration; t < kDuration + kWatchedAfterEnd; t += 1e-4) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      double off = 0;
      for (int i = 0; i < 2; ++i) {
        off +=
            modes.eigenvectors()(static_cast<Eigen::Index>(j), i) *
            std::imag(amplitude[static_cast<std::size_t>(i)] * std::polar(1.0, std::sqrt(modes.eigenvalues()[i]) * t));
      }
      expected[j] = std::max(expected[j], std::abs(off));
    }
  }

  const ElasticRun run = run_on_elastic_arm(robot, rigid_reference(robot, GetParam(), from, to, kDuration));
  ASSERT_EQ(run.simulation.failure, "");
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_GT(expected[j], 5e-3) << j;  // or nothing would be tested
    // Second order in angles of 0.07 rad.
    EXPECT_NEAR(run.figures.residual[j], expected[j], 0.02 * expected[j]) << j;
  }
}

// ---- the page ----

std::size_t count_of(const std::string& part, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

Json data_of(const std::string& html) {
  const std::string open = "<script type='application/json' id='plan-data'>";
  const std::size_t from = html.find(open);
  if (from == std::string::npos) return nullptr;
  const std::size_t begin = from + open.size();
  return Json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

PlanRecord record_of(const std::string& request) {
  const Problem problem = parse_request(request, "reach.yaml", load_parameters(kRobot));
  Plan made = plan(problem, {});
  return {"plan.json", plan_json(problem, made), problem.robot, made.trajectory};
}

const PlanRecord& reach() {
  static const PlanRecord record = record_of("start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\n");
  return record;
}

TEST(PlanPage, HoldsTheMotionAndWhatItIsComparedWith) {
  const std::string html = plan_page(reach());
  const Json data = data_of(html);
  ASSERT_EQ(data["motions"].size(), 3U);
  const Json& motion = data["motions"][0];
  const std::vector<Sample>& rows = reach().trajectory->samples;
  ASSERT_EQ(motion["time"].size(), rows.size());      // few enough to be there all
  for (std::size_t i = 0; i < rows.size(); i += 7) {  // six digits
    EXPECT_NEAR(motion["time"][i].get<double>(), rows[i].time, 1e-8);
    EXPECT_NEAR(motion["q2"][i].get<double>(), rows[i].state.q[1], 1e-5);
    EXPECT_NEAR(motion["theta1"][i].get<double>(), rows[i].state.theta[0], 1e-5);
    EXPECT_NEAR(motion["tau1"][i].get<double>(), rows[i].torque[0], 1e-4);
  }
  EXPECT_NEAR(data["motions"][2]["time"].back().get<double>(), rows.back().time + kWatchedAfterEnd, 1e-6);
  EXPECT_EQ(data["limits"]["torque"], Json({12.0, 5.0}));
  EXPECT_EQ(data["arm"]["radius"], Json({0.03, 0.025}));
  EXPECT_TRUE(data["scene"].empty());
  for (const char* heading : {"Motion", "Margins", "Certificate", "Had it been planned without the springs",
                              "Mesh and error", "Objective", "Solver", "Request"}) {
    EXPECT_THAT(html, HasSubstr("<h2>" + std::string(heading) + "</h2>"));
  }
  EXPECT_THAT(html, HasSubstr("spring deflection 1"));
  EXPECT_EQ(count_of("<canvas id='chart", html), count_of("\"x_label\":", html));  // each has its data
  EXPECT_EQ(html, plan_page(reach()));
}

// The plan is run by the same code as the profiles, and held after its end by the same as in the certificate.
TEST(PlanPage, TheComparedPlanHasTheCertificatesResidual) {
  const ElasticRun run = run_on_elastic_arm(reach().robot, *reach().trajectory);
  const Json& residual = reach().plan["certificate"]["residual"]["link_vibration_rad"];
  for (std::size_t j = 0; j < kJoints; ++j) {
    // Their ends differ by the integrators' tolerance. Ends moved by that, 1e-8, were measured to change the residual
    // by up to 2.1e-6 rad, for other encoder counts are read; with 1e-10 by 4.5e-8.
    EXPECT_NEAR(run.figures.residual[j], residual[j].get<double>(), 3e-6) << j;
    const ElasticRun textbook = run_on_elastic_arm(
        reach().robot,
        rigid_reference(reach().robot, Profile::kMinimumJerk, {0, 0}, {1.2, -0.8}, reach().trajectory->end_time()));
    EXPECT_GT(textbook.figures.residual[j], 50 * run.figures.residual[j])
        << j;  // what planning with the springs is for
  }
}

// ---- two plans ----

PlanRecord gentle() {
  PlanRecord record = record_of("start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\nduration: 0.8\n");
  record.plan["request"] = "gentle";
  return record;
}

TEST(BothPlansPage, HasBothMotionsAndTheirFigures) {
  const std::string html = both_plans_page(reach(), gentle());
  const Json data = data_of(html);
  ASSERT_EQ(data["motions"].size(), 2U);
  EXPECT_EQ(data["beside"], 1);
  EXPECT_EQ(data["motions"][0]["name"], "reach");
  EXPECT_EQ(data["motions"][1]["name"], "gentle");
  EXPECT_NEAR(data["motions"][1]["time"].back().get<double>(), 0.8, 1e-9);
  EXPECT_EQ(data["motions"][1]["arm"]["length"], Json({0.345, 0.305}));
  for (const char* part :
       {"<td>0.01 x effort + 0.001 x link acceleration</td>", "<td>time</td>", "<td>0.8</td>", "link 1, gentle"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST(BothPlansPage, PlansOfOneNameAreToldApartByTheirFolders) {
  PlanRecord other = reach();
  other.source = "elsewhere/plan.json";
  const Json data = data_of(both_plans_page(reach(), other));
  EXPECT_EQ(data["motions"][1]["name"], "reach in elsewhere");
}

TEST(BothPlansPage, AskForMotions) {
  PlanRecord none = reach();
  none.trajectory.reset();
  EXPECT_THROW(both_plans_page(reach(), none), InputError);
}

// The weights times what the terms come to on the run of the plan itself are the objective that it was planned for.
TEST(PlanPage, TheObjectiveIsComparedWithThatOfTheProfiles) {
  const PlanRecord record = gentle();
  const ElasticRun run = run_on_elastic_arm(record.robot, *record.trajectory);
  Trajectory until_end;
  for (const Sample& s : run.simulation.samples) {
    if (s.time <= record.trajectory->end_time()) until_end.samples.push_back(s);
  }
  const std::map<std::string, double> terms = terms_of_rows(record.robot, until_end);
  const Json& planned = record.plan["objective"]["terms"];
  for (const auto& [name, value] : terms) {
    // Torques of the run have feedback, below 1 % of the limits; of the accelerations it moves next to nothing.
    EXPECT_NEAR(value, planned[name].get<double>(), 1e-3 * std::abs(value)) << name;
  }
  EXPECT_EQ(terms.count("torque_rate"), 0U);
  const std::string html = plan_page(record);
  for (const char* label : {"objective: effort (N^2 m^2 s)", "objective: link acceleration (rad^2/s^3)",
                            "objective: 0.01 x effort + 0.001 x link acceleration"}) {
    EXPECT_THAT(html, HasSubstr(label));
  }
  EXPECT_THAT(html, Not(HasSubstr("Not compared is")));
}

TEST(PlanPage, SaysWhichRepetitionOfThePlanItIs) {
  PlanRecord record = gentle();
  const std::string sentence = "learnt: repetition 3; status and certificate are of the plan before";
  EXPECT_THAT(plan_page(record), Not(HasSubstr("learnt:")));
  record.plan["repetition"] = nlohmann::ordered_json::parse(R"({
    "number": 3, "log": "second.csv", "fraction": 0.5, "reasons": ["torque of joint 1 reaches 12.5"],
    "runs": [{"number": 1, "link_error_rms_rad": [0.00958738, 0.000958738], "motors_began_rad": [0, 0]},
             {"number": 2, "link_error_rms_rad": [0.00191748, 0.000287621], "motors_began_rad": [0, 0]}],
    "rehearsals": [{"arm": "the model", "link_error_rms_rad": [0.0479369, 0], "broken": [], "task": [],
                    "limits": [{"name": "torque", "joint": 1, "limit": 12, "reached": 6, "rollout": 9},
                               {"name": "torque", "joint": 2, "limit": 5, "reached": 1, "rollout": 1}]}]})");
  const std::string html = plan_page(record);
  EXPECT_THAT(html, HasSubstr(sentence));
  EXPECT_LT(html.find(sentence), html.find("class='badge"));
  const std::string text =
      std::regex_replace(html.substr(html.find("These rows are for"), 4000), std::regex("<[^>]*>\\s*"), "|");
  EXPECT_THAT(text, HasSubstr("These rows are for run 3"));
  EXPECT_THAT(text, HasSubstr("0.5 of the correction was taken. torque of joint 1 reaches 12.5."));
  EXPECT_THAT(text, HasSubstr("Corrected by log second.csv"));
  EXPECT_THAT(text, ContainsRegex("\\|1\\|+100\\|+10\\|"));  // a count is 2 pi / 65536
  EXPECT_THAT(text, ContainsRegex("\\|2\\|+20\\|+3\\|"));
  EXPECT_THAT(text, ContainsRegex("the model\\|+500\\|+0\\|+torque 1\\|+75.0 %"));
}

TEST(PlanPage, SaysWhatOfTheObjectiveIsNotCompared) {
  PlanRecord record = gentle();
  record.plan["resolved_request"]["objective"]["torque_rate"] = 0.1;
  EXPECT_THAT(plan_page(record), HasSubstr("Not compared is what the plan was to do as to torque rate"));
}

TEST(PlanPage, WithoutAMotionShowsWhatWasAskedFor) {
  PlanRecord record = reach();
  record.trajectory.reset();
  record.plan["status"] = "infeasible";
  record.plan["resolved_request"]["other_goals"] = Json::array({record.plan["resolved_request"]["goal"]});
  Json data = data_of(plan_page(record));
  EXPECT_TRUE(data["motions"].empty());
  ASSERT_EQ(data["poses"].size(), 3U);
  EXPECT_EQ(data["poses"][1], (Json{{"label", "goal"}, {"q", {1.2, -0.8}}}));
  record.plan["resolved_request"]["goal"]["q"][0] = nullptr;  // free
  const std::string html = plan_page(record);
  EXPECT_EQ(data_of(html)["poses"].size(), 2U);
  EXPECT_THAT(html, HasSubstr("A goal with a free joint is not drawn."));
}

// With rows (--keep-uncertified) and without.
TEST(PlanPage, WhatIsUncertifiedIsCalledSoAndDrawn) {
  PlanRecord record = reach();
  record.plan["status"] = "uncertified";
  record.plan["reason"] = "link 2 is up to 0.7 rad off the plan";
  const std::string html = plan_page(record);
  EXPECT_THAT(html, HasSubstr("<span class='badge bad'>uncertified</span>"));
  EXPECT_THAT(html, HasSubstr("link 2 is up to 0.7 rad off the plan"));
  EXPECT_FALSE(data_of(html)["motions"].empty());
  record.trajectory.reset();
  const Json data = data_of(plan_page(record));
  EXPECT_TRUE(data["motions"].empty());
  EXPECT_EQ(data["poses"].size(), 2U);
}

TEST(PlanPage, NeedsNothingButItself) {
  std::string html = plan_page(reach());
  const std::size_t library = html.find(kChartJs);
  ASSERT_NE(library, std::string::npos);
  html.erase(library, std::string(kChartJs).size());
  for (const char* part : {"http", "src=", "href=", "url(", "@import", "<link", "NaN", "import(", "fetch(", "nan<"}) {
    EXPECT_THAT(html, Not(HasSubstr(part)));
  }
}

TEST(PlanPage, TextsCannotBreakThePage) {
  PlanRecord record = reach();
  const std::string hostile = "</script><script>alert(1)</script><img src=x onerror=alert(2)>'\"&\xff";
  record.plan["request"] = hostile;
  record.plan["reason"] = hostile;
  record.plan["solver"]["stages"][0]["name"] = hostile;
  record.plan["certificate"]["limits"][0]["name"] = hostile;
  record.plan["novelty"] = {{hostile, {{"deep", {{{"a", hostile}}}}}}};
  record.plan["resolved_request"]["via"] = {{{"time", 0.1}, {"q", {0.1, 0.2}}, {hostile, 1}}};
  const std::string html = plan_page(record), sane = plan_page(reach());
  EXPECT_EQ(count_of("</script", html), count_of("</script", sane));
  EXPECT_EQ(count_of("<script", html), count_of("<script", sane));
  EXPECT_EQ(count_of("<img", html), 0U);
  EXPECT_THAT(html, HasSubstr("&lt;img src=x"));
}

Json scene_of(const std::string& request) {
  const Problem problem =
      parse_request("start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\n" + request, "reach.yaml", load_parameters(kRobot));
  const Json json = plan_json(problem, {});
  return scene_json(JsonField(json, "plan.json"), problem.robot);
}

void expect_at(const Json& point, double x, double y) {
  EXPECT_NEAR(point[0].get<double>(), x, 1e-12);
  EXPECT_NEAR(point[1].get<double>(), y, 1e-12);
}

TEST(Scene, HoldsWhatTheRequestAsksForOnTheWay) {
  EXPECT_TRUE(scene_of("").empty());
  const Json scene = scene_of(
      "obstacles: [{center: [0.3, -0.7], radius: 0.05, margin: 0.01}]\n"
      "tip: {box: [[-0.7, -0.7], [0.7, 0.3]]}\nvia: [{q: [0.7, -0.2]}]\n");
  ASSERT_EQ(scene.size(), 3U);
  EXPECT_EQ(
      scene[0],
      Json({{"kind", "disc"}, {"center", {0.3, -0.7}}, {"radius", 0.05}, {"margin", 0.01}, {"label", "obstacles[0]"}}));
  EXPECT_EQ(scene[1]["corners"], Json({{-0.7, -0.7}, {0.7, 0.3}}));
  const Point<double> tip = tip_position(load_parameters(kRobot), Joints<double>{0.7, -0.2});
  EXPECT_EQ(scene[2]["kind"], "point");
  expect_at(scene[2]["at"], tip.x, tip.y);
}

TEST(Scene, ArcsLeadTheShortWayFromOnePointToTheOther) {
  const Parameters robot = load_parameters(kRobot);
  const Point<double> from = tip_position(robot, Joints<double>{0, 0}),
                      to = tip_position(robot, Joints<double>{1.2, -0.8});
  const double x = 0.5 * (from.x + to.x), y = 0.5 * (from.y + to.y);  // and a little aside: the way is then decided
  const double cx = x + 0.3 * (to.y - from.y), cy = y - 0.3 * (to.x - from.x);
  const Json scene =
      scene_of(fmt::format("tip: {{arc: {{center: [{}, {}], from: [{}, {}], to: [{}, {}], tolerance: 0.05}}}}\n", cx,
                           cy, from.x, from.y, to.x, to.y));
  ASSERT_EQ(scene.size(), 1U);
  const auto at = [&](const char* angle) {
    const double a = scene[0][angle], r = scene[0]["radius"];
    return Json{cx + r * std::cos(a), cy + r * std::sin(a)};
  };
  expect_at(at("from"), from.x, from.y);
  expect_at(at("to"), to.x, to.y);
  EXPECT_LT(std::abs(scene[0]["to"].get<double>() - scene[0]["from"].get<double>()), std::numbers::pi);
}

TEST(Scene, PathsAreCurvesOfTheTipThroughTheirCorners) {
  const Json scene = scene_of("path: {points: [[0.5, 0.3]], tolerance: 0.01}\n");
  ASSERT_FALSE(scene.empty());
  EXPECT_EQ(scene[0]["kind"], "curve");
  const Json& points = scene[0]["points"];
  ASSERT_EQ(points.size(), 42U);
  const Parameters robot = load_parameters(kRobot);
  const Point<double> corner = tip_position(robot, Joints<double>{0.5, 0.3});
  expect_at(points[0], 0, -robot.link.length[0] - robot.link.length[1]);
  expect_at(points[20], corner.x, corner.y);
  expect_at(points[21], corner.x, corner.y);
}

TEST(PlanPage, ShowsTheSceneAndTheRoomLeftInIt) {
  PlanRecord record = reach();
  record.plan["certificate"]["task"] = {
      {{"name", "obstacles[0]"}, {"link", 2}, {"room", -0.0125}, {"unit", "m"}, {"time", 0.1}, {"passed", false}}};
  record.plan["resolved_request"]["via"] = {{{"time", 0.2}, {"q", {0.7, -0.2}}, {"dq", nullptr}}};
  const std::string html = plan_page(record);
  ASSERT_EQ(data_of(html)["scene"].size(), 1U);
  EXPECT_EQ(data_of(html)["scene"][0]["label"], "via, 0.2 s");
  EXPECT_THAT(html, HasSubstr("<td>obstacles[0], link 2</td><td class='over'>-0.0125</td><td>m</td>"));
  EXPECT_THAT(html, HasSubstr("They go straight, whatever else the request asks for on the way"));
}

TEST(PlanPage, ShowsWhatIsProven) {
  PlanRecord record = reach();
  const std::string heading = "<h2>Proof</h2>";
  EXPECT_THAT(plan_page(record), Not(HasSubstr(heading)));
  const double count = record.plan["certificate"]["tolerance_rad"];
  const auto loop = [&](double first, double second) {
    return Json{{"proven", first <= count},
                {"until", 0.25},
                {"reason", nullptr},
                {"link_error_rad", {first, second}},
                {"time_of_max_link_error", 0.1},
                {"uncertainty_rad", 3e-10},
                {"steps", 1234}};
  };
  Json& proof = record.plan["certificate"]["proof"];
  proof = {
      {"verdict", "proven"},
      {"until", 0.43},
      {"reason", nullptr},
      {"open_loop", loop(count / 4, count / 8)},
      {"closed_loop", loop(count / 16, 0)},
      {"limits",
       {{{"name", "motor_velocity"}, {"joint", 2}, {"allowed", 8.000008}, {"published", 7.75}, {"rollout", 7.875}}}},
      {"task",
       {{{"name", "obstacles[0]"}, {"link", 1}, {"unit", "m"}, {"room", 0.0125}, {"time", 0.1}, {"rollout", 0.0124}}}}};
  std::string html = plan_page(record);
  EXPECT_THAT(html, HasSubstr(heading));
  EXPECT_THAT(html, HasSubstr("Proven: enclosures of the exact motion hold these bounds"));
  EXPECT_THAT(html, HasSubstr("<td>open loop</td><td>0.25</td><td>0.125</td><td>3e-10</td><td>0.25</td><td>1234</td>"));
  EXPECT_THAT(html, HasSubstr("<td>motor velocity 2</td><td>8.000008</td><td>7.75</td><td>7.875</td>"));
  EXPECT_THAT(html, HasSubstr("<td>obstacles[0], link 1</td><td>0.0125</td><td>0.0124</td><td>m</td>"));
  proof["verdict"] = "not_proven";
  proof["reason"] = "not proven from t = 0.250000 s: open loop: link 1 may be off";
  proof["open_loop"] = loop(2 * count, 0);
  html = plan_page(record);
  EXPECT_THAT(html, HasSubstr("<p class='warning'>not proven from t = 0.250000 s: open loop: link 1 may be off</p>"));
  EXPECT_THAT(html, HasSubstr("<td>open loop</td><td class='over'>2</td>"));
}

TEST(PlanPage, ComparesOnlyWhatLeadsFromRestToRest) {
  PlanRecord record = reach();
  record.trajectory->samples.resize(record.trajectory->samples.size() / 2);
  const std::string html = plan_page(record);
  EXPECT_THAT(html, HasSubstr("There is no such comparison"));
  EXPECT_EQ(data_of(html)["motions"].size(), 1U);
}

TEST(PlanPage, OfAPlanWithoutTrajectorySaysWhy) {
  PlanRecord record = reach();
  record.plan["status"] = "infeasible";
  record.plan["reason"] = "the shortest motion takes 0.43 s";
  record.trajectory.reset();
  const std::string html = plan_page(record);
  EXPECT_THAT(html, HasSubstr("the shortest motion takes 0.43 s"));
  EXPECT_THAT(html, HasSubstr("<h2>Solver</h2>"));
}

// In milliseconds, as nothing but time counts; the most expensive limit first.
TEST(PlanPage, SaysWhatMoreOfEachActiveLimitWouldSave) {
  PlanRecord record = reach();
  Json idle = {{"name", "link_position"}, {"joint", 1}, {"limit", 3.2}, {"unit", "rad"}, {"worth", 0.0}};
  Json cheap = {{"name", "torque"}, {"joint", 2}, {"limit", 5.0}, {"unit", "N m"}, {"worth", 0.001}};
  Json dear = {{"name", "tip_box"}, {"joint", nullptr}, {"limit", 0.1}, {"unit", "m"}, {"worth", 0.0523}};
  for (Json* l : {&idle, &cheap, &dear}) (*l)["active_share"] = l == &idle ? 0 : 0.25;
  idle["active"] = Json::array();
  cheap["active"] = dear["active"] = {{0.1, 0.2}, {0.25, 0.3}};
  record.plan["sensitivity"]["limits"] = {idle, cheap, dear};
  const std::string html = plan_page(record);
  EXPECT_THAT(html, HasSubstr("<td>tip box</td><td>0.1 m</td><td>0.001 m</td><td>0.0523</td><td>25 %</td>"
                              "<td class='long'>0.1000 to 0.2000, 0.2500 to 0.3000</td></tr>\n<tr><td>torque 2</td>"
                              "<td>5 N m</td><td>0.05 N m</td><td>0.05</td>"));
  EXPECT_THAT(html, HasSubstr("<th>1 % more</th><th>would save (ms)</th>"));
}

TEST(PlanPage, ShowsSectionsItDoesNotKnow) {
  PlanRecord record = reach();
  record.plan["novelty"] = {{{"limit", "torque_1"}, {"worth", -0.0123}}, {{"limit", "torque_2"}, {"worth", 4.5}}};
  record.plan["optimality"] = {{"hamiltonian", {{"mean", -1.0}, {"values", std::vector<double>(30, 0.25)}}}};
  const std::string html = plan_page(record);
  for (const char* part :
       {"<h2>Novelty</h2>", "torque_1", "-0.0123", "<h2>Optimality</h2>", "<h3>hamiltonian</h3>", "30 entries"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST(PlanPage, NamesWhatIsMissingOrOfAnotherKind) {
  const auto complaint = [](const PlanRecord& record) {
    try {
      plan_page(record);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  PlanRecord record = reach();
  record.plan["certificate"]["limits"][1].erase("reached");
  EXPECT_EQ(complaint(record), "plan.json: certificate.limits[1].reached: missing");
  record = reach();
  record.plan["mesh"]["node_times"] = "many";
  EXPECT_EQ(complaint(record), "plan.json: mesh.node_times: must be a list");
  record = reach();
  record.plan["mesh"]["errors"].erase(0);
  EXPECT_THAT(complaint(record), HasSubstr("mesh: must have one more of node_times"));
  record = reach();
  record.plan["solver"] = nullptr;
  EXPECT_EQ(complaint(record), "plan.json: solver: must be an object");
}

// ---- folders ----

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    write("plan.json", json_text(reach().plan));
    Trajectory trajectory = *reach().trajectory;
    trajectory.metadata["rows"] = std::to_string(trajectory.samples.size());
    write_csv(trajectory, folder_ / "trajectory.csv");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  void write_changed(const char* pointer, const Json& value) const {
    Json plan = reach().plan;
    plan[Json::json_pointer(pointer)] = value;
    write("plan.json", json_text(plan));
  }
  std::string complaint() const {
    try {
      read_plan(folder_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }

  fs::path folder_ = fs::temp_directory_path() / ("fjr_report_test_" + std::to_string(::getpid()));
};

TEST_F(Folder, IsReadAsItWasWritten) {
  const PlanRecord record = read_plan(folder_);
  EXPECT_EQ(robot_hash(record.robot), robot_hash(reach().robot));
  EXPECT_EQ(record.trajectory->samples.size(), reach().trajectory->samples.size());
  EXPECT_EQ(plan_page(record), plan_page(reach()));
}

// The robot that a request was planned for has the request's payload.
TEST_F(Folder, RemembersThePayload) {
  const Problem problem =
      parse_request("start: {q: [0, 0]}\ngoal: {q: [0.5, 0]}\npayload: {mass: 0.3, inertia: 0.001}\n", "reach.yaml",
                    load_parameters(kRobot));
  write("plan.json", json_text(plan_json(problem, {})));
  EXPECT_EQ(read_plan(folder_).robot.payload, problem.robot.payload);
  write_changed("/robot/payload/mass", 0.3);
  EXPECT_THAT(complaint(), HasSubstr("robot: is not the robot that robot_hash tells of"));
}

TEST_F(Folder, ThatIsNoPlanIsRefusedWithTheReason) {
  write_changed("/robot/spring/stiffness/1", 18);
  EXPECT_THAT(complaint(), HasSubstr("plan.json: robot: is not the robot that robot_hash tells of"));
  write_changed("/robot/spring/stiffness", nullptr);
  EXPECT_THAT(complaint(), HasSubstr("plan.json: robot.spring.stiffness: must be a list"));
  write_changed("/request_hash", "another");
  EXPECT_THAT(complaint(), HasSubstr("trajectory.csv: request_hash: is not that of the plan.json beside it"));
  write("plan.json", "{\"status\": \"certified\"");
  EXPECT_THAT(complaint(), HasSubstr("plan.json: is damaged"));
  write("plan.json", "[1, 2]");
  EXPECT_THAT(complaint(), HasSubstr("plan.json: must be an object"));
  write("plan.json", json_text(bad_input_json("reach", "goal.q[1]: 9 rad is outside", "goal.q[1]")));
  EXPECT_THAT(complaint(), HasSubstr("nothing planned: goal.q[1]: 9 rad is outside"));
  fs::remove(folder_ / "plan.json");
  EXPECT_THAT(complaint(), HasSubstr("plan.json: cannot be read: this is no folder of a plan"));
  fs::remove_all(folder_);
  EXPECT_THAT(complaint(), HasSubstr("is no folder"));
}

TEST_F(Folder, WithADamagedTrajectoryIsRefused) {
  const fs::path rows = folder_ / "trajectory.csv";
  fs::resize_file(rows, fs::file_size(rows) / 2);
  EXPECT_THAT(complaint(), HasSubstr("trajectory.csv"));
  Trajectory cut = *reach().trajectory;
  cut.metadata["rows"] = std::to_string(cut.samples.size());
  cut.samples.pop_back();
  write_csv(cut, rows);
  EXPECT_THAT(complaint(), HasSubstr("but says that it had"));
  fs::remove(rows);
  EXPECT_THAT(complaint(), HasSubstr("trajectory.csv: no such file"));
}

}  // namespace
}  // namespace fjr
