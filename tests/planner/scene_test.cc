// What the report draws beside the arm.
#include "planner/results/report/scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "model/kinematics.h"
#include "tests/planner/reported_plan.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

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

// A picture without an obstacle that this version does not know would mislead.
TEST(Scene, RefusesWhatThisVersionDoesNotKnow) {
  const Problem problem =
      parse_request("start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\n", "reach.yaml", load_parameters(kRobot));
  Json json = plan_json(problem, {});
  const auto scene = [&] { return scene_json(JsonField(json, "plan.json"), problem.robot); };
  EXPECT_NO_THROW(scene());
  json["resolved_request"]["task"]["spheres"] = Json::array({{{"centre", {0.3, -0.7, 0}}, {"radius", 0.05}}});
  try {
    scene();
    ADD_FAILURE() << "a constraint that is not known was left out";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("spheres"), std::string::npos) << error.what();
  }
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

}  // namespace
}  // namespace fjr
