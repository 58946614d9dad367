// What valid requests resolve to.
#include "planner/request/request.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "model/flatness.h"
#include "planner/problem/problem.h"
#include "planner/problem/relaxable.h"
#include "planner/request/keys.h"
#include "tests/planner/parsed_request.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using ::testing::StartsWith;
using P = Joints<double>;

// A limit of one joint is written and read again, and there is none of the other but the robot's.
TEST(Request, OneJointAloneMayBeLimited) {
  const Parameters robot = load_parameters(kRobot);
  Request request = read(kMove);
  request.limits.torque[0] = 10;
  for (const Request& same : {request, read(format_request(request)), read(kMove + "limits: {torque: [10, .inf]}\n")}) {
    EXPECT_EQ(resolve(same, robot).limits.torque, (Joints<double>{10, robot.limits.torque[1]}));
  }
}

// The hash of what says nothing of it is that of before there was a choice.
TEST(Keys, HaveUnitsThatNumbersBelowThemShare) {
  EXPECT_EQ(unit_of_key("goal.q[1]"), "rad");
  EXPECT_EQ(unit_of_key("via[2].time"), "s");
  EXPECT_EQ(unit_of_key("via[2].dq[0]"), "rad/s");
  EXPECT_EQ(unit_of_key("tip.box[0][1]"), "m");
  EXPECT_EQ(unit_of_key("limits.torque[0]"), "N m");
  EXPECT_EQ(unit_of_key("objective"), "");  // a number without a unit
  EXPECT_EQ(unit_of_key("goal"), "");
  EXPECT_EQ(unit_of_key("gaol[0"), "");
}

TEST(Request, ATrackingErrorIsPricedWhereSomethingIsUncertain) {
  const std::string payload = "payload: {value: 0.1, unit: kg, standard_error: 0.01}\n";
  const Problem priced = parse(kMove + payload + "objective: {time: 1, tracking: {weight: 2e4}}\n");
  EXPECT_EQ(priced.weights.tracking, 2e4);
  const std::string number = kMove + payload + "objective: {time: {weight: 1}, tracking: 2e4}\n";
  EXPECT_EQ(parse(number).request_hash, priced.request_hash);
  EXPECT_EQ(parse(format_request(read_request(number, "request.yaml"))).request_hash, priced.request_hash);
  EXPECT_NE(parse(kMove + payload).request_hash, priced.request_hash);
  // What is uncertain decides such a plan.
  const std::string better_known = "payload: {value: 0.1, unit: kg, standard_error: 0.005}\n";
  EXPECT_NE(parse(kMove + better_known + "objective: {time: 1, tracking: 2e4}\n").request_hash, priced.request_hash);
  EXPECT_EQ(error_of(kMove + "objective: {time: 1, tracking: {weight: 2e4}}\n"),
            "request.yaml: objective.tracking: the robot has neither covariance nor standard errors, and the payload "
            "none: nothing is uncertain");
  EXPECT_EQ(error_of(kMove + payload + "duration: 1\nobjective: {tracking: 1}\n"),
            "request.yaml: objective.tracking: needs another term beside it, which says what it is traded for; add "
            "time: 1 or effort: 1");
  EXPECT_EQ(error_of(kMove + payload + "objective: {time: 1, tracking: -1}\n"),
            "request.yaml: objective.tracking: -1 is outside [0, 1e+09]");
  EXPECT_EQ(error_of(kMove + payload + "objective: {time: 1, tracking: {wieght: 1}}\n"),
            "request.yaml: objective.tracking: unknown key \"wieght\"; allowed: weight; did you mean weight?");
  EXPECT_EQ(error_of(kMove + payload + "duration: 1\nobjective: {time: 1, tracking: 1}\n"),
            "request.yaml: objective: time alone has nothing to choose when the duration is fixed; add another weight, "
            "such as effort: 1");
}

TEST(Request, SearchIsAChoice) {
  EXPECT_EQ(parse(kMove).search, Thoroughness::kDefault);
  EXPECT_EQ(parse(kMove + "search: default\n").request_hash, parse(kMove).request_hash);
  EXPECT_EQ(parse(kMove + "search: quick\n").search, Thoroughness::kQuick);
  EXPECT_NE(parse(kMove + "search: quick\n").request_hash, parse(kMove).request_hash);
  EXPECT_NE(parse(kMove + "search: thorough\n").request_hash, parse(kMove + "search: quick\n").request_hash);
  EXPECT_EQ(error_of(kMove + "robust: {confidence: 0.99}\n"),
            "request.yaml: robust: the robot has neither covariance nor standard errors, and the payload none: nothing "
            "is uncertain");
  const std::string payload = "payload: {value: 0.1, unit: kg, standard_error: 0.01}\n";
  EXPECT_EQ(parse(kMove + payload + "robust: {confidence: 0.99}\n").robust, 0.99);
  EXPECT_NE(parse(kMove + payload + "robust: {confidence: 0.99}\n").request_hash, parse(kMove + payload).request_hash);
  EXPECT_EQ(parse(kMove + payload).request_hash, parse(kMove + "payload: 0.1\n").request_hash);
  EXPECT_EQ(error_of(kMove + payload + "robust: {confidence: 1}\n"),
            "request.yaml: robust.confidence: 1 is outside [0.5, 0.999]");
  EXPECT_EQ(error_of(kMove + "search: slow\n"),
            "request.yaml: search: \"slow\" is not one of quick, default, thorough");
}

TEST(Request, AProofIsAskedForOrNot) {
  EXPECT_FALSE(parse(kMove).proven);
  EXPECT_TRUE(parse(kMove + "proven: true\n").proven);
  EXPECT_NE(parse(kMove + "proven: true\n").request_hash, parse(kMove).request_hash);
  EXPECT_EQ(parse(kMove + "proven: false\n").request_hash, parse(kMove).request_hash);
  EXPECT_EQ(error_of(kMove + "proven: perhaps\n"),
            "request.yaml: proven: must be true or false, not the text \"perhaps\"");
}

TEST(Request, MethodIsAScheme) {
  EXPECT_EQ(parse(kMove).method, "hermite-simpson");
  EXPECT_EQ(parse(kMove + "method: hermite-simpson\n").request_hash, parse(kMove).request_hash);
  EXPECT_NE(parse(kMove + "method: lobatto4\n").request_hash, parse(kMove).request_hash);
  EXPECT_EQ(error_of(kMove + "method: euler\n"),
            "request.yaml: method: \"euler\" is not one of trapezoidal, hermite-simpson, lobatto4, radau3");
}

TEST(Request, DefaultsAreFastestFromRestToRestInFreeTime) {
  const Problem problem = parse(kMove);
  const State<double> rest = rest_at(problem.robot, {1.2, -0.8});
  EXPECT_TRUE(problem.start_at_rest);
  EXPECT_EQ(problem.start.q, (P{0, 0}));
  EXPECT_TRUE(problem.goal.at_rest);
  EXPECT_EQ(problem.goal.dq, (P{0, 0}));
  EXPECT_EQ(problem.goal.theta, rest.theta);
  EXPECT_EQ(problem.goal.dtheta, (P{0, 0}));
  EXPECT_EQ(problem.duration.min, 0.02);
  EXPECT_EQ(problem.duration.max, 20);
  expect_weights(problem.weights, 1, 0, 0, 0);
  EXPECT_EQ(problem.sample_period, 0.001);
  EXPECT_EQ(problem.seed, 1U);
  EXPECT_EQ(problem.name, "request");
  EXPECT_EQ(problem.limits.torque, (P{12, 5}));
  EXPECT_EQ(problem.limits.motor_velocity, (P{6, 8}));
  EXPECT_EQ(problem.limits.link_position, (P{3.2, 2.6}));
  EXPECT_EQ(problem.limits.spring_deflection, (P{0.3864, 0.2262}));
  EXPECT_EQ(problem.limits.torque_rate, (P{kNoLimit, kNoLimit}));
  EXPECT_EQ(problem.limits.tip_speed, kNoLimit);
}

TEST(Request, PresetsDependOnWhetherTheDurationIsFixed) {
  expect_weights(parse(kMove + "duration: 1.5").weights, 0, 0.01, 0, 1e-3);
  expect_weights(parse(kMove + "duration: 1.5\nobjective: gentle").weights, 0, 0.01, 0, 1e-3);
  expect_weights(parse(kMove + "duration: 1.5\nobjective: efficient").weights, 0, 1, 0, 0);
  expect_weights(parse(kMove + "duration: free\nobjective: gentle").weights, 1, 0.01, 0, 1e-3);
  expect_weights(parse(kMove + "duration: {min: 0.4, max: 2}\nobjective: efficient").weights, 1, 1, 0, 0);
  expect_weights(parse(kMove + "objective: fastest").weights, 1, 0, 0, 0);
  expect_weights(parse(kMove + "objective: {time: 2, torque_rate: 1e-4}").weights, 2, 0, 1e-4, 0);
  expect_weights(parse(kMove + "duration: 1\nobjective: {link_acceleration: 3, effort: 0}").weights, 0, 0, 0, 3);
}

TEST(Request, DurationsResolve) {
  EXPECT_TRUE(parse(kMove + "duration: 1.5").duration.fixed());
  const Problem between = parse(kMove + "duration: {min: 0.4, max: 2.0}");
  EXPECT_EQ(between.duration.min, 0.4);
  EXPECT_EQ(between.duration.max, 2);
  EXPECT_EQ(parse(kMove + "duration: {max: 2.0}").duration.min, 0.02);
  EXPECT_EQ(parse(kMove + "duration: {min: 2.0}").duration.max, 20);
  EXPECT_EQ(parse(kMove + "duration: {min: 20}").duration.max, 120);  // which leaves a choice
  EXPECT_TRUE(parse(kMove + "duration: {min: 2, max: 2}").duration.fixed());
}

TEST(Request, MayAskToStayForSomeTime) {
  for (const char* duration : {"0.5", "{min: 0.5}", "{min: 0.5, max: 2}"}) {
    EXPECT_NO_THROW(parse(fmt::format("start: {{q: [0.3, 0]}}\ngoal: {{q: [0.3, 0]}}\nduration: {}\n", duration)));
  }
  EXPECT_ANY_THROW(parse("start: {q: [0.3, 0]}\ngoal: {q: [0.3, 0]}\nduration: {max: 2}\n"));
}

TEST(Request, LimitsOnlyTighten) {
  const Problem problem = parse(kMove +
                                "limits: {torque: [10, 4], motor_velocity: [6, 2], link_position: [2, 1], "
                                "spring_deflection: [0.35, 0.2], torque_rate: [100, 50], tip_speed: 1.5}");
  EXPECT_EQ(problem.limits.torque, (P{10, 4}));
  EXPECT_EQ(problem.limits.motor_velocity, (P{6, 2}));
  EXPECT_EQ(problem.limits.link_position, (P{2, 1}));
  EXPECT_EQ(problem.limits.spring_deflection, (P{0.35, 0.2}));
  EXPECT_EQ(problem.limits.torque_rate, (P{100, 50}));
  EXPECT_EQ(problem.limits.tip_speed, 1.5);
  EXPECT_EQ(problem.robot.limits.torque, (P{12, 5}));  // the robot stays what it is
}

TEST(Request, AMovingStartFollowsByFlatness) {
  const Problem problem = parse("start: {q: [0.5, 0.2], dq: [1, -1]}\n" + kGoal);
  const FlatPoint flat = from_link_motion(problem.robot, {.q = {0.5, 0.2}, .dq = {1, -1}});
  EXPECT_FALSE(problem.start_at_rest);
  EXPECT_EQ(problem.start.dq, (P{1, -1}));
  EXPECT_EQ(problem.start.theta, flat.state.theta);
  EXPECT_EQ(problem.start.dtheta, flat.state.dtheta);
}

TEST(Request, AStartIsTakenAsGiven) {
  const Problem motors = parse("start: {q: [0.5, 0.2], theta: [0.6, 0.25], dtheta: [0.5, 0]}\n" + kGoal);
  EXPECT_FALSE(motors.start_at_rest);
  EXPECT_EQ(motors.start.dq, (P{0, 0}));
  EXPECT_EQ(motors.start.theta, (P{0.6, 0.25}));
  EXPECT_EQ(motors.start.dtheta, (P{0.5, 0}));

  const Problem turning = parse("start: {q: [0.5, 0.2], dtheta: [0.5, 0]}\n" + kGoal);
  EXPECT_FALSE(turning.start_at_rest);
  EXPECT_EQ(turning.start.theta, rest_at(turning.robot, {0.5, 0.2}).theta);

  const Problem wound = parse("start: {q: [0.5, 0.2], dq: [1, 0], theta: [0.6, 0.25]}\n" + kGoal);
  EXPECT_EQ(wound.start.theta, (P{0.6, 0.25}));
  EXPECT_EQ(wound.start.dtheta, from_link_motion(wound.robot, {.q = {0.5, 0.2}, .dq = {1, 0}}).state.dtheta);

  EXPECT_TRUE(parse("start: {q: [0, 0], dq: [0, 0], theta: [0, 0], dtheta: [0, 0]}\n" + kGoal).start_at_rest);
}

TEST(Request, GoalsResolve) {
  const Problem thrown = parse(kStart + "goal: {q: [1, 0], dq: [2, 1]}");
  EXPECT_FALSE(thrown.goal.at_rest);
  EXPECT_EQ(thrown.goal.dq, (P{2, 1}));
  EXPECT_FALSE(thrown.goal.theta.has_value());
  EXPECT_FALSE(thrown.goal.dtheta.has_value());

  const Problem stopped = parse(kStart + "goal: {q: [1, 0], dq: [0, 0]}");
  EXPECT_TRUE(stopped.goal.at_rest);
  EXPECT_EQ(stopped.goal.theta, rest_at(stopped.robot, {1, 0}).theta);

  const Problem full = parse(kStart + "goal: {q: [1, 0], dq: [2, 1], theta: [1.1, 0.1], dtheta: [2, 1]}");
  EXPECT_EQ(full.goal.theta, (P{1.1, 0.1}));
  EXPECT_EQ(full.goal.dtheta, (P{2, 1}));

  const Problem wound = parse(kStart + "goal: {q: [1, 0], dq: [0, 0], theta: [1.1, 0.1]}");
  EXPECT_FALSE(wound.goal.at_rest);
  EXPECT_FALSE(wound.goal.dtheta.has_value());

  const Problem spelled_out =
      parse(kStart + "goal: {q: [0, 0], dq: [0, 0], theta: [0, 0], dtheta: [0, 0]}\nduration: 1");
  EXPECT_TRUE(spelled_out.goal.at_rest);
}

TEST(Request, ViasResolve) {
  const Problem problem =
      parse(kMove + "duration: 1\nvia: [{time: 0.3, q: [0.6, 0.4]}, {time: 0.301, q: [0.7, 0.4], dq: [1, 0]}]");
  ASSERT_EQ(problem.via.size(), 2U);
  EXPECT_EQ(problem.via[0].time, 0.3);
  EXPECT_EQ(problem.via[0].q, (P{0.6, 0.4}));
  EXPECT_FALSE(problem.via[0].dq.has_value());
  EXPECT_EQ(problem.via[1].dq, (P{1, 0}));
  EXPECT_TRUE(parse(kMove + "via: []").via.empty());
  // With a fixed duration a motion may end where it began.
  EXPECT_TRUE(parse(kStart + "goal: {q: [0, 0]}\nduration: 1").goal.at_rest);
}

TEST(Request, SeedAndSamplePeriodAreRead) {
  const Problem problem = parse(kMove + "seed: 18446744073709551615\nsample_period: 0.005");
  EXPECT_EQ(problem.seed, 18446744073709551615U);
  EXPECT_EQ(problem.sample_period, 0.005);
  EXPECT_EQ(parse(kMove + "seed: 0").seed, 0U);
}

TEST(Request, AsManyRowsAsATrajectoryMayHaveAreAccepted) {
  EXPECT_EQ(parse(kMove + "duration: 16.3835\nsample_period: 0.0005").duration.max, 16.3835);  // 32767 intervals
}

// Rows farther apart than were asked for would not be what was asked for.
TEST(Request, OnlyWhereNothingIsSaidLongMotionsMayHaveRowsFartherApart) {
  const Problem open = parse(kMove + "duration: 100"), asked = parse(kMove + "duration: 10\nsample_period: 0.001");
  EXPECT_EQ(open.sample_period, asked.sample_period);
  EXPECT_EQ(open.longest_sample_period, 0.005);
  EXPECT_EQ(asked.longest_sample_period, 0.001);
  EXPECT_NE(parse(kMove + "duration: 10").request_hash, asked.request_hash);
}

TEST(Request, RobotsAreFoundRelativeToTheRequest) {
  std::string name = (fs::temp_directory_path() / "fjr_XXXXXX").string();
  const fs::path folder = mkdtemp(name.data());
  fs::create_directories(folder / "cell");
  fs::copy_file(kRobot, folder / "robot.yaml");
  std::ofstream(folder / "cell/pick.yaml") << "robot: ../robot.yaml\n" << kMove;
  const Problem problem = load_request(folder / "cell/pick.yaml", "/nonexistent/robot.yaml");
  EXPECT_EQ(problem.name, "pick");
  EXPECT_EQ(problem.request_hash, parse(kMove).request_hash);
  std::ofstream(folder / "robot.yaml") << "link: 1\n";
  try {
    load_request(folder / "cell/pick.yaml", kRobot);
    ADD_FAILURE() << "a broken robot was accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(e.source(), (folder / "cell/../robot.yaml").string());  // blamed on the robot's file, not on the request
  }
  EXPECT_THROW(load_request(folder / "none.yaml", kRobot), InputError);
  fs::remove_all(folder);
}

TEST(Request, APayloadReplacesTheRobots) {
  const Problem plain = parse(kMove), loaded = parse(kMove + "payload: 0.1");
  EXPECT_EQ(loaded.robot.payload, (Payload{0.1, 0}));
  EXPECT_EQ(parse(kMove + "payload: {mass: 0.1, inertia: 0.001}").robot.payload, (Payload{0.1, 0.001}));
  EXPECT_NE(loaded.request_hash, plain.request_hash);
  EXPECT_NE(robot_hash(loaded.robot), robot_hash(plain.robot));
  EXPECT_EQ(parse(kMove + "payload: 0").request_hash, plain.request_hash);
  // Resting with it takes more of springs and motors.
  EXPECT_NEAR((loaded.goal.theta->at(0) - plain.goal.theta->at(0)) * plain.robot.spring.stiffness[0],
              gravity_torque(loaded.robot, loaded.goal.q)[0] - gravity_torque(plain.robot, plain.goal.q)[0], 1e-12);
}

TEST(Request, ReleaseIsWhereTheArmMovesUnlessSaid) {
  const std::string vias = "via: [{q: [0.1, 0.1]}, {q: [0.2, 0.1]";
  EXPECT_FALSE(parse(kMove).release);
  EXPECT_EQ(parse(kMove + vias + "}]").release, 1U);
  EXPECT_EQ(parse(kMove + "via: [{q: [0.1, 0.1], release: true}, {q: [0.2, 0.1]}]").release, 0U);
  const std::string moving = "start: {q: [0, 0]}\ngoal: {q: [0.6, 0.1], dq: free}\n";
  EXPECT_FALSE(parse(moving + vias + "}]").release);
  EXPECT_EQ(parse(moving + vias + ", release: true}]").release, 1U);
  EXPECT_TRUE(parse(moving).goal.dq_free);
  EXPECT_FALSE(parse(moving).goal.at_rest || parse(moving).goal.theta || parse(moving).goal.dtheta);
  expect_refused({
      {kMove + "via: [{q: [0.1, 0.1], release: true}, {q: [0.2, 0.1], release: true}]",
       "via[1].release: is said of another via point already"},
      {kMove + "via: [{q: [0.1, 0.1], release: 1}]", "via[0].release: must be true or false, not the number 1"},
      {kMove + "objective: {time: 1, tip_speed: 1}",
       "objective.tip_speed: the arm moves nowhere that is named: needs a via point, or a moving goal"},
      {"start: {q: [0, 0]}\ngoal: {q: [0.6, 0.1], dq: free, theta: [0.6, 0.1]}\n",
       "goal.theta: does not go with goal.dq: free, which leaves the motors free"},
  });
}

// Both elbows put the tip where it was asked for, at the velocity that was asked for.
TEST(Request, ATipThatRestsMayBeAsFarAwayAsTheArmReaches) {
  const Problem rests = parse("start: {q: [0.3, 0.2]}\ngoal: {tip: [0, -0.65], tip_velocity: [0, 0]}\n");
  EXPECT_TRUE(rests.goal.at_rest);
}

TEST(Request, TipGoalIsASetOfPostures) {
  const Problem problem = parse("start: {q: [0.3, 0.2]}\ngoal: {tip: [0.3, -0.4], tip_velocity: [0.5, -0.3]}\n");
  std::vector<Goal> goals{problem.goal};
  goals.insert(goals.end(), problem.other_goals.begin(), problem.other_goals.end());
  ASSERT_EQ(goals.size(), 2u);
  EXPECT_LT(goals[0].q[1] * goals[1].q[1], 0);
  for (const Goal& goal : goals) {
    const Point<double> tip = tip_position(problem.robot, goal.q), moves = tip_velocity(problem.robot, goal.q, goal.dq);
    EXPECT_NEAR(tip.x, 0.3, 1e-12);  // roundings of an arc cosine away from its ends
    EXPECT_NEAR(tip.y, -0.4, 1e-12);
    EXPECT_NEAR(moves.x, 0.5, 1e-12);
    EXPECT_NEAR(moves.y, -0.3, 1e-12);
    EXPECT_FALSE(goal.at_rest);
  }
  // Where it cannot be had, it is called what the request calls it.
  const std::vector<Relaxable> all = relaxables(problem);
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const Relaxable& r) { return r.name == "goal.tip_velocity"; }));
}

// Where the arm may be is no limit of what it can do: it does not keep all of these from being larger.
TEST(Relaxables, AllLimitsMayGrowToTheRobots) {
  const Problem tightened =
      parse(kMove + "limits: {torque: [6, 2.5], motor_velocity: [3, 4], spring_deflection: [0.33, 0.15]}\n");
  const Relaxable all = all_limits(tightened);
  EXPECT_NEAR(all.allowed, 0.3864 / 0.33 - 1, 1e-9);  // of robot.yaml's deflection, which is the nearest
  EXPECT_EQ(all_limits(parse(kMove)).allowed, 0);
}

TEST(Request, ElbowIsOnTheSideOfTheLineFromBaseToTip) {
  for (const std::string side : {"left", "right"}) {
    const Problem problem = parse("start: {q: [0.3, 0.2]}\ngoal: {tip: [0.3, -0.4], elbow: " + side + "}\n");
    EXPECT_TRUE(problem.other_goals.empty());
    const Point<double> elbow = elbow_position(problem.robot, problem.goal.q);
    const double cross = 0.3 * elbow.y + 0.4 * elbow.x;  // of the line to the tip with the one to the elbow
    EXPECT_EQ(cross > 0, side == "left");
  }
}

TEST(Request, PathPassesItsPointsInOrder) {
  const Problem problem = parse(kMove + "path: {points: [[0.5, 0.3], [0.9, -0.2]], tolerance: 0.01}\n");
  ASSERT_EQ(problem.via.size(), 2u);
  EXPECT_EQ(problem.via[1].q, (P{0.9, -0.2}));
  EXPECT_FALSE(problem.via[0].time);
  ASSERT_EQ(problem.task.path->corners.size(), 4u);
  EXPECT_EQ(problem.task.path->corners.back(), (P{1.2, -0.8}));
}

}  // namespace
}  // namespace fjr
