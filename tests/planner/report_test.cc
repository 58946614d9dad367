// The report of a plan, and that of two: what the page holds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "common/chart_page.h"
#include "common/input_error.h"
#include "planner/ocp/objective.h"
#include "planner/results/report/both_plans_page.h"
#include "planner/results/report/plan_page.h"
#include "planner/results/report/rigid_profile.h"
#include "tests/planner/reported_plan.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

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

PlanRecord gentle() {
  PlanRecord record = record_of("start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\nduration: 0.8\n");
  record.plan["request"] = "gentle";
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

TEST(PlanPage, ShowsTheSceneAndItsClearance) {
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

// ---- two plans ----

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

}  // namespace
}  // namespace fjr
