// Plans that have to keep more than the limits, held against plain geometry: no code of the task's rows.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/input_error.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

using testing::HasSubstr;

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

Plan certified(const std::string& yaml) {
  const Problem problem =
      parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
  Plan result = plan(problem, {});
  EXPECT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  return result;
}

using Point2 = std::array<double, 2>;

// The paper's link lengths and the shipped radii. [m]
constexpr double kLength1 = 0.345, kLength2 = 0.305, kRadius1 = 0.03, kRadius2 = 0.025;

Point2 elbow(const Joints<double>& q) { return {kLength1 * std::sin(q[0]), -kLength1 * std::cos(q[0])}; }
Point2 tip(const Joints<double>& q) {
  const Point2 e = elbow(q);
  return {e[0] + kLength2 * std::sin(q[0] + q[1]), e[1] - kLength2 * std::cos(q[0] + q[1])};
}

double from_segment(const Point2& p, const Point2& a, const Point2& b) {
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double s = std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(p[0] - a[0] - s * dx, p[1] - a[1] - s * dy);
}

// Calls look(time, q) every 50 us of the published motion.
template <class Look>
void look_along(const Plan& plan, const Look& look) {
  if (!plan.trajectory) return;
  Interpolator at(*plan.trajectory);
  for (double t = 0; t < plan.duration; t += 5e-5) look(t, at.at(t).state.q);
}

// 1e-6 of what is asked for, as for limits; 50 us miss less than a micrometre of a curve.
constexpr double kMissed = 1e-6;  // [m]

double least_clearance(const Plan& plan, const Point2& centre, double radius) {
  double least = 1;
  look_along(plan, [&](double, const Joints<double>& q) {
    least = std::min({least, from_segment(centre, {0, 0}, elbow(q)) - radius - kRadius1,
                      from_segment(centre, elbow(q), tip(q)) - radius - kRadius2});
  });
  return least;
}

TEST(TaskPlan, BothLinksKeepClearOfADiscThatBarsTheStraightWay) {
  const Plan result = certified(
      "{start: {q: [-0.8, 0]}, goal: {q: [0.8, 0]}, obstacles: [{center: [0, -0.62], radius: 0.05, margin: 0.005}]}");
  const double clearance = least_clearance(result, {0, -0.62}, 0.055);
  EXPECT_GT(clearance, -kMissed);
  EXPECT_LT(clearance, 1e-3);  // the way round is as tight as it is allowed to be
  const Plan free = certified("{start: {q: [-0.8, 0]}, goal: {q: [0.8, 0]}}");
  EXPECT_LT(least_clearance(free, {0, -0.62}, 0.055), -0.05);  // it does bar the way
  EXPECT_GT(result.duration, free.duration);
  ASSERT_EQ(result.certificate->task.size(), 2u);
  // The certificate looks at other instants: apart by what 50 us move the arm at 6 m/s, squared over twice the
  // distance.
  EXPECT_NEAR(std::min(result.certificate->task[0].clearance, result.certificate->task[1].clearance), clearance, 8e-6);
}

// Ends of the links, of which one is furthest beyond a straight line; seen at instants that the planner does not know.
TEST(TaskPlan, BothLinksKeepToTheirSideOfAWall) {
  const std::string motion = "{start: {q: [-0.8, 0]}, goal: {q: [0.8, 0]}";
  const Plan result = certified(motion + ", walls: [{point: [0.3, -0.57], normal: [0, 2], margin: 0.005}]}"),
             free = certified(motion + "}");
  const auto lowest = [](const Plan& plan) {
    const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
    double least = 1;
    look_along(plan, [&](double, const Joints<double>& q) {
      const double elbow = -p.link.length[0] * std::cos(q[0]), tip = elbow - p.link.length[1] * std::cos(q[0] + q[1]);
      least = std::min({least, elbow - std::max(p.link.radius[0], p.link.radius[1]), tip - p.link.radius[1]});
    });
    return least;
  };
  EXPECT_GT(lowest(result), -0.565 - kMissed);
  EXPECT_LT(lowest(result), -0.564);  // as deep as it may
  EXPECT_LT(lowest(free), -0.6);      // the wall is in the way
  EXPECT_GT(result.duration, free.duration);
  ASSERT_EQ(result.certificate->task.size(), 2u);
  EXPECT_EQ(result.certificate->task[1].name, "walls[0]");
  EXPECT_EQ(result.certificate->task[1].link, 2);
  EXPECT_NEAR(result.certificate->task[1].clearance, lowest(result) + 0.565,
              8e-6);  // the certificate looks at other instants
}

// Where the joints' limits leave no way round, the wall is named, and with what is named there is a motion.
TEST(TaskPlan, AWallThatBarsEveryWayIsNamedWithWhatWouldDo) {
  const std::string motion = "{start: {q: [-0.8, 0]}, goal: {q: [0.8, 0]}, limits: {link_position: [1.5, 0.3]}, ";
  const Plan result = plan(request(motion + "walls: [{point: [0, -0.57], normal: [0, 1]}]}"), {});
  ASSERT_EQ(result.status, PlanStatus::kInfeasible);
  EXPECT_THAT(result.reason, HasSubstr("barred by walls[0]"));
  EXPECT_THAT(result.reason, HasSubstr("walls[0] alone would have to be moved back by"));
  const double back = result.infeasibility->relaxations.front().to;
  EXPECT_LT(back, 0.12);
  certified(motion + fmt::format("walls: [{{point: [0, {}], normal: [0, 1]}}]}}", -0.57 - back));
}

TEST(TaskPlan, AWallThatTheArmCannotStandBesideIsRefused) {
  const auto refusal = [](const std::string& wall) -> std::string {
    try {
      request("{start: {q: [0, 0]}, goal: {q: [0.5, 0]}, walls: [" + wall + "]}");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("{point: [0, 0.1], normal: [0, 1]}"),
              HasSubstr("walls[0]: the base of the arm, [0, 0] m, is 0.1 m"));
  EXPECT_THAT(refusal("{point: [0, -1], normal: [0, 0]}"), HasSubstr("walls[0].normal: has no direction"));
  EXPECT_THAT(refusal("{point: [0, -1], normal: [0, 1], margin: -1}"), HasSubstr("walls[0].margin: -1 m is outside"));
  EXPECT_THAT(refusal("{point: [0, -0.5], normal: [0, 1]}"), HasSubstr("start: link 2 would be"));
}

TEST(TaskPlan, TipKeepsToALine) {
  const Point2 from{0.42206, -0.46756}, to{0.45, -0.1};
  const Plan result = certified(
      "{start: {q: [0.5, 0.5]}, goal: {tip: [0.45, -0.1], elbow: right}, "
      "tip: {line: {from: [0.42206, -0.46756], to: [0.45, -0.1], tolerance: 0.002}}}");
  double furthest = 0;
  look_along(result,
             [&](double, const Joints<double>& q) { furthest = std::max(furthest, from_segment(tip(q), from, to)); });
  EXPECT_LT(furthest, 0.002 + kMissed);
  EXPECT_GT(furthest, 0.0018);  // a faster motion uses what it is given
}

// 241 degrees about [0.32, -0.2] m, to the left: the short way would be to the right.
TEST(TaskPlan, TipKeepsToAnArcBeyondHalfATurn) {
  const Point2 center{0.32, -0.2};
  const double radius = 0.1, tolerance = 0.02;
  const Plan result = certified(
      "{start: {q: [0.33846686702355033, 2.0640669532382474]}, goal: {q: [0.33094525650277518, 1.4959281989151574]}, "
      "tip: {arc: {center: [0.32, -0.2], from: [0.32, -0.1], to: [0.40715757724135881, -0.24902608213406996], "
      "tolerance: 0.02, way: long}}}");
  double furthest = 0, turned = 0;
  std::optional<double> before;
  look_along(result, [&](double, const Joints<double>& q) {
    const Point2 at = tip(q);
    furthest = std::max(furthest, std::abs(std::hypot(at[0] - center[0], at[1] - center[1]) - radius));
    const double angle = std::atan2(at[1] - center[1], at[0] - center[0]);
    if (before) turned += std::remainder(angle - *before, 2 * M_PI);
    before = angle;
  });
  EXPECT_LT(furthest, tolerance + kMissed);
  EXPECT_NEAR(turned, 4.2, 0.01);
}

TEST(TaskPlan, AnglesFollowAPathCornerByCorner) {
  const Plan result = certified(
      "{start: {q: [0, 0]}, goal: {q: [1.2, -0.8]}, path: {points: [[0.6, 0.2], [1, -0.2]], tolerance: 0.01}}");
  const std::array<Point2, 4> corners{{{0, 0}, {0.6, 0.2}, {1, -0.2}, {1.2, -0.8}}};
  ASSERT_EQ(result.via_times.size(), 2u);
  std::array<double, 4> nearest;
  nearest.fill(1);
  look_along(result, [&](double, const Joints<double>& q) {
    double off = 1;
    for (std::size_t k = 0; k + 1 < corners.size(); ++k)
      off = std::min(off, from_segment(q, corners[k], corners[k + 1]));
    EXPECT_LT(off, 0.01 + 1e-8);
    for (std::size_t k = 0; k < 4; ++k) {
      nearest[k] = std::min(nearest[k], std::hypot(q[0] - corners[k][0], q[1] - corners[k][1]));
    }
  });
  for (const double distance : nearest) EXPECT_LT(distance, 0.01);
}

// Times are free: no slower than with the times that the motion itself chose, and than any others.
TEST(TaskPlan, FreeViaTimesAreTheBestOnes) {
  const std::string head = "{start: {q: [0, 0]}, goal: {q: [1.2, -0.8]}, ";
  const Plan free = certified(head + "via: [{q: [0.6, 0.4]}, {q: [1, 0]}]}");
  ASSERT_EQ(free.via_times.size(), 2u);
  Interpolator at(*free.trajectory);
  const Joints<double> first = at.at(free.via_times[0]).state.q, second = at.at(free.via_times[1]).state.q;
  EXPECT_NEAR(first[0], 0.6, 1e-6);  // interpolation between rows
  EXPECT_NEAR(first[1], 0.4, 1e-6);
  EXPECT_NEAR(second[0], 1, 1e-6);
  EXPECT_NEAR(second[1], 0, 1e-6);
  // The same duration is not enough when the first via point has to come earlier.
  const std::string via = "via: [{q: [0.6, 0.4], time: " + std::to_string(0.9 * free.via_times[0]) +
                          "}, {q: [1, 0]}], objective: efficient, duration: ";
  const Problem tight = parse_request(head + via + std::to_string(0.99 * free.duration) + "}", "request.yaml",
                                      FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
  PlanOptions one;
  one.starts = 1;
  EXPECT_NE(plan(tight, one).status, PlanStatus::kCertified);
}

TEST(TaskPlan, TheBetterElbowWins) {
  const Plan either = certified("{start: {q: [0, 0]}, goal: {tip: [0.45, -0.2]}}");
  const Plan left = certified("{start: {q: [0, 0]}, goal: {tip: [0.45, -0.2], elbow: left}}");
  const Plan right = certified("{start: {q: [0, 0]}, goal: {tip: [0.45, -0.2], elbow: right}}");
  EXPECT_NEAR(either.duration, std::min(left.duration, right.duration),
              2e-3 * either.duration);  // two ways of refining
  const Point2 end = tip(either.trajectory->samples.back().state.q);
  EXPECT_NEAR(end[0], 0.45, 1e-8);
  EXPECT_NEAR(end[1], -0.2, 1e-8);
}

// The joint that may end anywhere ends at rest, where the fixed goal at the same place is no faster.
TEST(TaskPlan, FreeJointEndsWhereItIsBest) {
  const Plan free = certified("{start: {q: [0, 0]}, goal: {q: [free, 1]}}");
  const State<double> end = free.trajectory->samples.back().state;
  EXPECT_NEAR(end.q[1], 1, 1e-8);
  EXPECT_TRUE(free.certificate->residual.evaluated);
  for (const double away : {-0.05, 0.05}) {
    const Plan fixed = certified("{start: {q: [0, 0]}, goal: {q: [" + std::to_string(end.q[0] + away) + ", 1]}}");
    EXPECT_GT(fixed.duration, free.duration);
  }
}

// The disc takes link 1 in the middle of its only way: joint 1 cannot turn the long way round.
TEST(TaskPlan, SaysThatEveryWayIsBarred) {
  const Problem problem =
      parse_request("{start: {q: [-0.8, 0]}, goal: {q: [0.8, 0]}, obstacles: [{center: [0, -0.25], radius: 0.05}]}",
                    "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
  const Plan result = plan(problem, {});
  EXPECT_EQ(result.status, PlanStatus::kInfeasible);
  EXPECT_NE(result.reason.find("barred by obstacles[0]"), std::string::npos) << result.reason;
}

}  // namespace
}  // namespace fjr
