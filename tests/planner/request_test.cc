// Requests: what valid ones resolve to, and the exact words with which broken ones are refused.
#include "planner/request/request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "model/flatness.h"
#include "planner/problem/problem.h"
#include "planner/request/keys.h"
#include "planner/request/request_keys.h"
#include "tests/support/random_requests.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using ::testing::StartsWith;
using P = Joints<double>;

const fs::path kRobot = fs::path(FJR_SOURCE_DIR) / "config/robot.yaml";

Problem parse(const std::string& yaml) { return parse_request(yaml, "request.yaml", ".", kRobot); }

std::string error_of(const std::string& yaml) {
  try {
    parse(yaml);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

// A valid request; tests append to it or replace its lines.
const std::string kMove = "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\n";
const std::string kStart = "start: {q: [0, 0]}\n", kGoal = "goal: {q: [1.2, -0.8]}\n";

void expect_weights(const Weights& w, double time, double effort, double torque_rate, double link_acceleration) {
  EXPECT_EQ(w.time, time);
  EXPECT_EQ(w.effort, effort);
  EXPECT_EQ(w.torque_rate, torque_rate);
  EXPECT_EQ(w.link_acceleration, link_acceleration);
}

Request read(const std::string& yaml) { return read_request(YamlNode::parse(yaml, "request.yaml")); }

// A request as a document of one line is the same request, to the last bit, whatever it asks for.
void expect_same_when_written(const Request& request, const Parameters& robot) {
  const std::string text = format_request(request);
  Request again = read_request(YamlNode::parse(text, request.source));
  EXPECT_EQ(format_request(again), text);
  EXPECT_EQ(resolve(again, robot).request_hash, resolve(request, robot).request_hash) << text;
}

TEST(Request, IsTheSameWhenItIsWrittenAndReadAgain) {
  const Parameters robot = load_parameters(kRobot);
  for (const fs::directory_entry& example : fs::directory_iterator(fs::path(FJR_SOURCE_DIR) / "config/requests")) {
    expect_same_when_written(read_request(YamlNode::load(example.path())), robot);
  }
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    expect_same_when_written(read(random_request(robot, seed).yaml), robot);
  }
  for (const char* more :
       {"tip: {arc: {center: [0, 0], from: [0.3, 0.52], to: [0.6, 0], tolerance: 0.01, way: long}}",
        "limits: {torque: [10, 4], tip_speed: 2.5}", "payload: {mass: 0.1, inertia: 0.001}",
        "objective: {time: 1, copper: 0.1}", "duration: {max: 3}", "method: radau3", "search: quick", "seed: 7",
        "payload: {mass: {value: 0.1, unit: kg, standard_error: 0.01}, inertia: 0.001}"}) {
    const Request request = read(kMove + more + "\n");
    EXPECT_EQ(format_request(read(format_request(request))), format_request(request)) << more;
    EXPECT_NE(format_request(request), format_request(read(kMove))) << more;
  }
}

// Where there is a choice of one thing: nothing of the earlier choice is left, neither in the problem nor on the wire.
TEST(Request, OneMemberThatIsSetCountsWhateverWasThereBefore) {
  const Parameters robot = load_parameters(kRobot);
  Request request = read(kMove + "objective: efficient\ntip: {box: [[-0.7, -0.7], [0.7, 0.7]]}\n");
  request.objective = Weights{.time = 2, .energy = 3};
  std::get<JointGoal>(request.goal).arrival = AnyVelocity{};
  request.tip = TipLine{{0, -0.65}, {0.5, 0.3}, 0.9};
  for (const Request& same : {request, read(format_request(request))}) {
    const Problem problem = resolve(same, robot);
    expect_weights(problem.weights, 2, 0, 0, 0);
    EXPECT_EQ(problem.weights.energy, 3);
    EXPECT_TRUE(problem.goal.dq_free);
    EXPECT_FALSE(problem.goal.at_rest);
    EXPECT_FALSE(problem.task.box);
    EXPECT_TRUE(problem.task.line);
  }
  request.objective = Preset::kGentle;
  std::get<JointGoal>(request.goal).arrival = Moving{{0.5, 0}, {}, {}};
  const Problem problem = resolve(request, robot);
  expect_weights(problem.weights, 1, 0.01, 0, 1e-3);
  EXPECT_FALSE(problem.goal.dq_free);
  EXPECT_EQ(problem.goal.dq, (Joints<double>{0.5, 0}));
}

// What is set in place of something else leaves nothing of it: not a velocity of the tip beside angles, not via points
// beside a path, not a bound beside a duration.
TEST(Request, OneKindTakesThePlaceOfAnother) {
  const Parameters robot = load_parameters(kRobot);
  Request request = read(
      "start: {q: [0, 0]}\ngoal: {tip: [0.3, -0.4], elbow: left, tip_velocity: [0.1, 0]}\n"
      "duration: {min: 0.5, max: 9}\nvia: [{q: [0.1, 0.1], release: true}]\n");
  request.goal = JointGoal{{1.2, -0.8}, AtRest{}};
  request.way = RequestedPath{{{0.5, -0.5}}, 0.05};
  request.duration = 2.0;
  EXPECT_EQ(
      format_request(request),
      "{start: {q: [0, 0]}, goal: {q: [1.2, -0.8]}, duration: 2, path: {points: [[0.5, -0.5]], tolerance: 0.05}}");
  for (const Request& same : {request, read(format_request(request))}) {
    const Problem problem = resolve(same, robot);
    EXPECT_TRUE(problem.goal.at_rest);
    EXPECT_TRUE(problem.other_goals.empty());
    EXPECT_TRUE(problem.task.path);
    EXPECT_FALSE(problem.release);
    EXPECT_TRUE(problem.duration.fixed());
  }
  request.goal = TipGoal{{0.3, -0.4}, Elbow::kLeft, {}};
  request.way = std::vector{RequestedVia{.q = {0.1, 0.1}, .dq = {}}};
  request.duration = FreeDuration{.min = {}, .max = 3};
  EXPECT_EQ(format_request(request),
            "{start: {q: [0, 0]}, goal: {tip: [0.3, -0.4], elbow: left}, duration: {max: 3}, via: [{q: [0.1, 0.1]}]}");
}

// A limit of one joint is written and read again, and there is none of the other but the robot's.
TEST(Request, OneJointAloneMayBeLimited) {
  const Parameters robot = load_parameters(kRobot);
  Request request = read(kMove);
  request.limits.torque[0] = 10;
  for (const Request& same : {request, read(format_request(request)), read(kMove + "limits: {torque: [10, .inf]}\n")}) {
    EXPECT_EQ(resolve(same, robot).limits.torque, (Joints<double>{10, robot.limits.torque[1]}));
  }
}

// What no document can say is refused in a program's request too, by the name of its member.
TEST(BrokenRequest, MembersThatAProgramSet) {
  const Parameters robot = load_parameters(kRobot);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refusal = [&](auto edit) -> std::string {
    Request request = read(kMove);
    edit(request);
    try {
      resolve(request, robot);
    } catch (const InputError& error) {
      return error.field();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal([&](Request& r) { r.start->q = {0, nan}; }), "start.q[1]");
  EXPECT_EQ(refusal([&](Request& r) { r.start->dq = {nan, 0}; }), "start.dq[0]");
  EXPECT_EQ(refusal([&](Request& r) { r.goal = JointGoal{{1.2, nan}, AtRest{}}; }), "goal.q[1]");
  EXPECT_EQ(refusal([&](Request& r) { r.goal = JointGoal{{1.2, -0.8}, Moving{{0, nan}, {}, {}}}; }), "goal.dq[1]");
  EXPECT_EQ(refusal([&](Request& r) { r.duration = FreeDuration{nan, {}}; }), "duration.min");
  EXPECT_EQ(refusal([&](Request& r) { r.objective = Weights{.time = 1, .effort = nan}; }), "objective.effort");
  EXPECT_EQ(refusal([&](Request& r) { r.limits.torque = {nan, 4}; }), "limits.torque[0]");
  EXPECT_EQ(refusal([&](Request& r) { r.limits.torque = {-1, 4}; }), "limits.torque[0]");
  EXPECT_EQ(refusal([&](Request& r) { r.sample_period = nan; }), "sample_period");
  EXPECT_EQ(refusal([&](Request& r) { r.payload = Payload{.mass = nan}; }), "payload.mass");
  EXPECT_EQ(refusal([&](Request& r) { r.way = std::vector{RequestedVia{.q = {nan, 0}}}; }), "via[0].q[0]");
  EXPECT_EQ(refusal([&](Request& r) {
              r.obstacles.push_back({.center = {0.5, nan}, .radius = 0.1});
            }),
            "obstacles[0].center[1]");
  // What contradicts another member.
  EXPECT_EQ(refusal([&](Request& r) { r.goal = JointGoal{}; }), "goal.q");
  EXPECT_EQ(refusal([&](Request& r) { r.duration = FreeDuration{2, 1}; }), "duration");
  EXPECT_EQ(refusal([&](Request& r) { r.way = std::vector{RequestedVia{.time = 0.2, .q = {0.5, 0}}}; }), "via[0].time");
  EXPECT_EQ(refusal([&](Request& r) { r.start.reset(); }), "start");
}

TEST(Request, AStartThatSaysNothingIsLeftOut) {
  for (const char* start : {"", "start:\n", "start: {}\n", "start: null\n"}) {
    EXPECT_FALSE(read(start + kGoal).start) << start;
  }
  EXPECT_TRUE(read(kMove).start);
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
  EXPECT_EQ(error_of(kMove + "proven: perhaps\n"), "request.yaml: proven: must be true or false");
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
  EXPECT_TRUE(parse(kMove + "duration: {min: 2, max: 2}").duration.fixed());
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

struct Broken {
  std::string yaml, message;
};

void expect_refused(const std::vector<Broken>& cases) {
  for (const Broken& c : cases) EXPECT_EQ(error_of(c.yaml), "request.yaml: " + c.message) << c.yaml;
}

TEST(BrokenRequest, ShapeOfTheDocument) {
  expect_refused({
      {"", "empty"},
      {"# nothing\n", "empty"},
      {"fastest",
       "must be a map with the keys robot, start, goal, duration, objective, via, obstacles, walls, tip, path, limits, "
       "sample_period, seed, payload, method, search, robust, proven, not the text \"fastest\""},
      {kMove + "durtion: 1",
       "unknown key \"durtion\"; allowed: robot, start, goal, duration, objective, via, obstacles, "
       "walls, tip, path, limits, sample_period, seed, payload, method, search, robust, proven; did you mean "
       "duration?"},
      {kMove + "seed: 1\nseed: 2", "line 4: key \"seed\" is given twice"},
      {kGoal, "start: missing; only a request to the service may leave it out, which then starts where the arm rests"},
      {kStart, "goal: missing"},
      {"start:\n" + kGoal,
       "start: missing; only a request to the service may leave it out, which then starts where the arm rests"},
  });
}

// The library's own words follow; what counts is the line.
TEST(BrokenRequest, Syntax) {
  EXPECT_THAT(error_of("start: {q: [0, 0}\n"), StartsWith("request.yaml: line 1: not valid YAML: "));
  EXPECT_THAT(error_of(kMove + "\tseed: 1"), StartsWith("request.yaml: line 3: not valid YAML: "));
  EXPECT_THAT(error_of(kMove + "seed: \"1"), StartsWith("request.yaml: line 3: not valid YAML: "));
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

TEST(BrokenRequest, PayloadsThatCannotBeHeld) {
  const std::string horizontal = "start: {q: [0, 0]}\ngoal: {q: [1.5, 0]}\n";
  EXPECT_NO_THROW((void)parse(horizontal + "payload: 0.1"));
  expect_refused({
      {kMove + "payload: -1", "payload: -1 kg is outside [0, 10]"},
      {kMove + "payload: {mass: 20}", "payload.mass: 20 kg is outside [0, 10]"},
      {kMove + "payload: {weight: 1}", "payload: unknown key \"weight\"; allowed: mass, inertia"},
      // (6.17 + 0.53 + 0.3 * 9.8 * 0.65) sin(1.5) N m on 20.48 N m/rad
      {horizontal + "payload: 0.3",
       "goal.q: joint 1: the spring would be deflected by 0.419406 rad with the payload of 0.3 kg, above the limit of "
       "0.3864 rad"},
      {horizontal + "payload: 0.1\nlimits: {torque: [7.2, 4], spring_deflection: [0.38, 0.2]}",
       "goal.q: joint 1: holding still here takes 7.31862 N m with the payload of 0.1 kg, above the limit of 7.2 N m"},
  });
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
      {kMove + "via: [{q: [0.1, 0.1], release: 1}]", "via[0].release: must be true or false"},
      {kMove + "objective: {time: 1, tip_speed: 1}",
       "objective.tip_speed: the arm moves nowhere that is named: needs a via point, or a moving goal"},
      {"start: {q: [0, 0]}\ngoal: {q: [0.6, 0.1], dq: free, theta: [0.6, 0.1]}\n",
       "goal.theta: does not go with goal.dq: free, which leaves the motors free"},
  });
}

TEST(BrokenRequest, Sets) {
  expect_refused({
      {kStart + "goal: {tip: [0.5, 0.5]}",
       "goal.tip: [0.5, 0.5] m is 0.707107 m from the base; the arm reaches from 0.04 to 0.65 m"},
      {kStart + "goal: {tip: [0.3, -0.4], elbow: up}", "goal.elbow: \"up\" is not one of any, left, right"},
      {kStart + "goal: {tip: [0.3, -0.4], dq: [0, 1]}", "goal.dq: does not go with goal.tip, which decides it"},
      {kStart + "goal: {tip: [0, -0.65], tip_velocity: [1, 0]}",
       "goal.tip_velocity: the stretched or folded arm cannot move its tip this way"},
      {kStart + "goal: {q: [1, 0], elbow: left}", "goal.elbow: goes with goal.tip; with goal.q give dq"},
      {kStart + "goal: {q: [free, free]}", "goal.q: one joint may be free, not both"},
      {kStart + "goal: {q: [free, 3]}", "goal.q[1]: 3 rad is outside [-2.6, 2.6]"},
      {kStart + "goal: {q: [free, 0]}", "goal: start and goal are the same state; nothing to plan"},
      {kStart + "goal: {q: [free, 1], dq: [0, 1], theta: [0, 0]}", "goal.theta: has no meaning beside a free joint"},
      {kMove + "via: [{time: 0.1, q: [0.6, 0.4]}]",
       "via[0].time: needs a fixed duration; without one a via point is passed at any time"},
  });
}

TEST(BrokenRequest, Task) {
  expect_refused({
      {kMove + "obstacles: [{center: [0.1, -0.6]}]", "obstacles[0].radius: missing"},
      {kMove + "obstacles: [{center: [0.1, -0.6], radius: -1}]", "obstacles[0].radius: -1 m is outside [0, 10]"},
      {kMove + "obstacles: [{center: [0.1, 20], radius: 1}]", "obstacles[0].center[1]: 20 m is outside [-10, 10]"},
      {kMove + "obstacles: [{center: [0, -0.7], radius: 0.05}]",
       "start: link 2 would be 0.025 m inside obstacles[0], its radius and margin included"},
      {kMove + "tip: {}", "tip: needs one of box, line, arc, and only one"},
      {kMove + "tip: {box: [[0.1, 0], [-0.1, 1]]}",
       "tip.box[1][0]: -0.1 m is not above the first corner's 0.1 m (lower left first, then upper right)"},
      {kMove + "tip: {box: [[-0.1, -0.1], [0.1, 0.1]]}", "start: puts the tip at [0, -0.65] m, 0.55 m outside tip.box"},
      {kMove + "tip: {line: {from: [0, -0.65], to: [0, -0.65], tolerance: 0.01}}",
       "tip.line.to: is the same point as from"},
      {kMove + "tip: {line: {from: [0, -0.65], to: [0.1, -0.65], tolerance: 0}}",
       "tip.line.tolerance: 0 m is outside [0.0001, 1]"},
      {kMove + "tip: {arc: {center: [0, 0], from: [0, -0.65], to: [0.6, 0], tolerance: 0.01}}",
       "tip.arc.to: lies 0.6 m from the center, from lies 0.65 m from it; they may differ by the tolerance of 0.01 m"},
      {kMove + "path: {points: [[0.1, 4]], tolerance: 0.01}", "path.points[0][1]: 4 rad is outside [-2.6, 2.6]"},
      {kMove + "path: {points: [], tolerance: 0.01}\nvia: [{q: [0.1, 0.1]}]",
       "path: goes through its points already; give either path or via"},
      {kMove + "duration: 0.5\nvia: [{q: [0.2, 0], time: 0.499}, {q: [0.3, 0]}]",
       "via: 1 points after 0.499 s leave no time until the end at 0.5 s, at least 0.001 s apart"},
      {"start: {q: [3.2, 0], dq: [1, 0]}\n" + kGoal,
       "start.dq: joint 1 stands on its limit of 3.2 rad and moves beyond it"},
      {kMove + "tip: {arc: {center: [0, 0], from: [0, -0.65], to: [0, -0.65], tolerance: 0.01}}",
       "tip.arc.to: is the same point as from; a full circle has no short way"},
      {"start: {q: [0.45, 0]}\ngoal: {q: [0.7, 0]}\n"
       "tip: {arc: {center: [0, 0], from: [0.3116266, -0.5704286], to: [0.3670176, -0.5364682], tolerance: 0.002}}",
       "start: puts the tip at [0.2827, -0.5853] m, 0.03221 m outside tip.arc"},
      {kMove + "path: {points: [[0, 0]], tolerance: 0.01}", "path.points[0]: is the same point as the one before it"},
  });
}

// Both elbows put the tip where it was asked for, at the velocity that was asked for.
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

TEST(BrokenRequest, StartAndGoal) {
  expect_refused({
      {kStart + "goal: {q: [0, 3.4]}", "goal.q[1]: 3.4 rad is outside [-2.6, 2.6]"},
      {"start: {q: [-3.3, 0]}\n" + kGoal, "start.q[0]: -3.3 rad is outside [-3.2, 3.2]"},
      {kMove + "limits: {link_position: [1, 1]}", "goal.q[0]: 1.2 rad is outside [-1, 1]"},
      {kStart + "goal: {q: [1]}", "goal.q: must be two numbers (rad), [joint 1, joint 2], not a list of 1"},
      {kStart + "goal: {q: [1, .nan]}", "goal.q[1]: \".nan\" is not a finite number (rad)"},
      {kStart + "goal: {q: [1, nan]}", "goal.q[1]: \"nan\" is not a finite number (rad)"},
      {kStart + "goal: {q: [1, 1,2]}", "goal.q: must be two numbers (rad), [joint 1, joint 2], not a list of 3"},
      {kStart + "goal: {q: [1, 30deg]}", "goal.q[1]: \"30deg\" is not a finite number (rad)"},
      {kStart + "goal: {dq: [1, 1]}", "goal.q: missing"},
      {kStart + "goal: {q: [1, 0], v: 3}",
       "goal: unknown key \"v\"; allowed: q, dq, theta, dtheta, tip, elbow, tip_velocity"},
      {kStart + "goal: {q: [1, 0], theta: [1, 0]}",
       "goal.theta: needs goal.dq beside it; without goal.dq the arm ends at rest and the motors with it"},
      {kStart + "goal: {q: [0, 0]}", "goal: start and goal are the same state; nothing to plan"},
      {kStart + "goal: {q: [1, 0], dq: [2, 1], dtheta: [2, -9]}",
       "goal.dtheta: joint 2: the motor would turn at 9 rad/s, above the limit of 8 rad/s"},
      {kStart + "goal: {q: [1, 0], dq: [2, 1], theta: [1.4, 0]}",
       "goal.theta: joint 1: the spring would be deflected by 0.4 rad, above the limit of 0.3864 rad"},
      {kStart + "goal: {q: [1, 0], dq: [1e6, 0]}", "goal.dq[0]: 1000000 rad/s is outside [-100, 100]"},
      {"start: {q: [0, 0], theta: [0, -0.3]}\n" + kGoal,
       "start.theta: joint 2: the spring would be deflected by 0.3 rad, above the limit of 0.2262 rad"},
      {"start: {q: [0, 0], dq: [0, 9]}\n" + kGoal,
       "start.dq: joint 2: the motor would turn at 9.26873 rad/s, above the limit of 8 rad/s"},
  });
}

TEST(BrokenRequest, GravityAndSpeed) {
  expect_refused({
      {kStart + "goal: {q: [1.5707963267948966, 0]}\nlimits: {torque: [6, 4]}",
       "goal.q: joint 1: holding still here takes 6.7 N m, above the limit of 6 N m"},
      {"start: {q: [0, 1.5707963267948966]}\n" + kGoal + "limits: {torque: [10, 0.5]}",
       "start.q: joint 2: holding still here takes 0.53 N m, above the limit of 0.5 N m"},
      {kStart + "goal: {q: [1.5707963267948966, 0]}\nlimits: {spring_deflection: [0.3, 0.2]}",
       "goal.q: joint 1: the spring would be deflected by 0.327148 rad, above the limit of 0.3 rad"},
      {kStart + "goal: {q: [1, 0], dq: [2, 0]}\nlimits: {tip_speed: 1.25}",
       "goal.dq: moves the tip at 1.3 m/s, above the limit of 1.25 m/s"},
      {"start: {q: [0, 0], dq: [2, 0]}\n" + kGoal + "limits: {tip_speed: 1.25}",
       "start.dq: moves the tip at 1.3 m/s, above the limit of 1.25 m/s"},
      {kMove + "duration: 1\nlimits: {tip_speed: 1.25}\nvia: [{time: 0.5, q: [0.5, 0], dq: [2, 0]}]",
       "via[0].dq: moves the tip at 1.3 m/s, above the limit of 1.25 m/s"},
  });
}

TEST(BrokenRequest, DurationAndObjective) {
  expect_refused({
      {kMove + "duration: 0.01", "duration: 0.01 s is outside [0.02, 120]"},
      {kMove + "duration: -1", "duration: -1 s is outside [0.02, 120]"},
      {kMove + "duration: soon", "duration: \"soon\" is not a finite number (s)"},
      {kMove + "duration: [1, 2]", "duration: must be a number of seconds, free, or {min, max}"},
      {kMove + "duration: {min: 2, max: 1}", "duration: min 2 s is above max 1 s"},
      {kMove + "duration: {min: 0.4, max: 121}", "duration.max: 121 s is outside [0.02, 120]"},
      {kMove + "duration: {minimum: 2}", "duration: unknown key \"minimum\"; allowed: min, max"},
      {kMove + "duration: 1\nobjective: fastest",
       "objective: fastest has nothing to choose when the duration is fixed; make it free, or choose gentle or "
       "efficient"},
      {kMove + "objective: quickest",
       "objective: \"quickest\" is not a preset (fastest, gentle, efficient); weights are given as {effort: 1, ...}"},
      {kMove + "objective: {effort: 1}",
       "objective: a duration that is not fixed needs a time weight; add time: 1, or fix the duration"},
      {kMove + "duration: 1\nobjective: {time: 1}",
       "objective: time alone has nothing to choose when the duration is fixed; add another weight, such as effort: 1"},
      {kMove + "objective: {time: -1}", "objective.time: -1 is outside [0, 1e+09]"},
      {kMove + "objective: {time: 0}", "objective: at least one weight must be > 0"},
      {kMove + "objective: {}", "objective: at least one weight must be > 0"},
      {kMove + "objective: {speed: 1}",
       "objective: unknown key \"speed\"; allowed: time, effort, torque_rate, link_acceleration, link_jerk, energy, "
       "copper, peak_torque, tip_speed, tracking"},
      {kMove + "objective:", "objective: must be a preset (fastest, gentle, efficient) or weights {effort: 1, ...}"},
  });
}

TEST(BrokenRequest, ViaPoints) {
  const std::string fixed = kMove + "duration: 1\nvia: ";
  std::string many = fixed + "[";
  for (int i = 0; i < 33; ++i) many += "{time: 0.5, q: [0, 0]},";
  expect_refused({
      {fixed + "{time: 0.5, q: [0, 0]}", "via: must be a list, not a map"},
      {fixed + "[{time: 0.5, q: [0, 2.7]}]", "via[0].q[1]: 2.7 rad is outside [-2.6, 2.6]"},
      {fixed + "[{time: 0.5}]", "via[0].q: missing"},
      {fixed + "[{time: 1, q: [0, 0]}]", "via[0].time: 1 s must lie between 0 s and 1 s, at least 0.001 s from both"},
      {fixed + "[{time: 0.5, q: [0, 0]}, {time: 0.4, q: [0, 0]}]",
       "via[1].time: 0.4 s must lie between 0.5 s and 1 s, at least 0.001 s from both"},
      {fixed + "[{time: 0.5, q: [0, 0]}, {time: 0.6, q: [1.5, 0]}]",  // 6 rad/s, 2 x 0.3864 rad
       "via[1].time: joint 1: 1.5 rad in 0.1 s from the time before; at 6 rad/s of the motor, and with the spring's "
       "deflection, at most 1.3728 rad are possible"},
      {fixed + "[{time: 0.5, q: [0, 0], theta: [0, 0]}]",
       "via[0]: unknown key \"theta\"; allowed: time, q, dq, release"},
      {many + "]", "via: 33 points, above the 32 allowed"},
  });
}

TEST(BrokenRequest, LimitsAndSampling) {
  expect_refused({
      {kMove + "limits: {torque: [15, 4]}",
       "limits.torque[0]: 15 N m is above the robot's 12 N m (limits may only tighten)"},
      {kMove + "limits: {torque: [10, 0]}", "limits.torque[1]: 0 N m must be > 0"},
      {kMove + "limits: {torque: 10}",
       "limits.torque: must be two numbers (N m), [joint 1, joint 2], not the text \"10\""},
      {kMove + "limits: {tip_speed: -1}", "limits.tip_speed: -1 m/s must be > 0"},
      {kMove + "limits: {link_velocity: [1, 1]}",
       "limits: unknown key \"link_velocity\"; allowed: torque, motor_velocity, link_position, spring_deflection, "
       "torque_rate, tip_speed, motor_power"},
      {kMove + "sample_period: 0.01", "sample_period: 0.01 s is outside [0.0005, 0.005]"},
      {kMove + "sample_period: 0.0005\nduration: 20",
       "sample_period: 20 s at 0.0005 s a row are 40001 rows, above the 32768 a trajectory may have; lengthen "
       "sample_period"},
      {kMove + "sample_period: 0.0005\nduration: {min: 16.384}",
       "sample_period: 16.384 s at 0.0005 s a row are 32769 rows, above the 32768 a trajectory may have; lengthen "
       "sample_period"},
      {kMove + "seed: -1", "seed: \"-1\" is not a whole number from 0 to 18446744073709551615"},
      {kMove + "seed: 1.5", "seed: \"1.5\" is not a whole number from 0 to 18446744073709551615"},
      {kMove + "robot: none.yaml", "robot: no such file: \"./none.yaml\""},
      {kMove + "robot: /dev/zero", "robot: not a file: \"/dev/zero\""},
      {kMove + "robot: [a]", "robot: must be text, not a list of 1"},
  });
}

TEST(RequestHash, DependsOnWhatIsMeantAndNotOnHowItIsWritten) {
  const std::string plain = parse(kMove).request_hash;
  EXPECT_EQ(plain.size(), 64U);
  EXPECT_EQ(parse("# hello\nseed: 1\nobjective: {time: 1.0}\ngoal: {q: [12e-1, -0.80]}\n"
                  "start: {q: [0, -0.0], dq: [0, 0]}\nduration: free\nlimits: {torque: [12, 5]}")
                .request_hash,
            plain);
  const std::vector<std::string> others{
      kMove + "seed: 2",
      kMove + "sample_period: 0.002",
      kMove + "objective: gentle",
      kMove + "duration: {max: 3}",
      kMove + "duration: {min: 0.3}",
      kMove + "limits: {torque: [11, 5]}",
      kMove + "limits: {torque_rate: [100, 100]}",
      kMove + "limits: {tip_speed: 9}",
      kMove + "duration: 1",
      kMove + "duration: 1\nvia: [{time: 0.5, q: [0, 0]}]",
      kMove + "duration: 1\nvia: [{time: 0.6, q: [0, 0]}]",
      kMove + "duration: 1\nvia: [{time: 0.6, q: [0, 0], dq: [0, 0]}]",
      kStart + "goal: {q: [1.2, -0.8], dq: [1, 0]}",
      kStart + "goal: {q: [1.2, -0.8], dq: [1, 0], theta: [1.2, -0.8]}",
      kStart + "goal: {q: [1.2, -0.8], dq: [1, 0], dtheta: [1, 0]}",
      kStart + "goal: {q: [1.2, -0.8000000000000002]}",
      "start: {q: [0, 0], dtheta: [0.1, 0]}\n" + kGoal,
      "start: {q: [0, 0], dq: [0.1, 0]}\n" + kGoal,
  };
  std::vector<std::string> seen{plain};
  for (const std::string& yaml : others) {
    seen.push_back(parse(yaml).request_hash);
    for (std::size_t i = 0; i + 1 < seen.size(); ++i) EXPECT_NE(seen.back(), seen[i]) << yaml;
  }
}

// A valid Problem promises what the planner relies on, whatever text it came from.
void expect_sound(const Problem& p) {
  for (int i = 0; i < kStates; ++i) EXPECT_TRUE(std::isfinite(p.start[i]));
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_LE(std::abs(p.goal.q[j]), p.limits.link_position[j]);
    EXPECT_LE(p.limits.torque[j], p.robot.limits.torque[j]);
    EXPECT_LE(std::abs(p.start.theta[j] - p.start.q[j]), p.limits.spring_deflection[j]);
    EXPECT_LE(std::abs(p.start.dtheta[j]), p.limits.motor_velocity[j]);
  }
  EXPECT_LE(p.duration.min, p.duration.max);
  EXPECT_TRUE(p.duration.fixed() || p.weights.time > 0);
  EXPECT_TRUE(!p.goal.at_rest || (p.goal.theta && p.goal.dtheta));
  for (std::size_t i = 0; i < p.via.size(); ++i) EXPECT_GT(p.via[i].time, i == 0 ? 0 : p.via[i - 1].time);
}

std::string mutated(std::string text, std::mt19937& random) {
  static const std::string kBytes = "{}[],:-#&*!|>'\"%@`?0123456789e.~<=\n\t ";
  const int edits = 1 + static_cast<int>(random() % 3);
  for (int e = 0; e < edits && !text.empty(); ++e) {
    const std::size_t at = random() % text.size();
    switch (random() % 4) {
      case 0:
        text.erase(at, 1 + random() % 8);
        break;
      case 1:
        text.insert(at, 1, kBytes[random() % kBytes.size()]);
        break;
      case 2:
        text[at] = static_cast<char>(random() % 256);
        break;
      default:
        text.insert(at, text.substr(random() % text.size(), random() % 12));
        break;
    }
  }
  return text;
}

TEST(Request, MutatedTextsAreReadOrRefused) {
  const std::vector<std::string> valid{
      kMove, "start: {q: [0.0, 0.0], dq: [1, -1]}\ngoal: {q: [1.2, -0.8], dq: [0.5, 0], theta: [1.3, -0.8]}\nseed: 7\n",
      kMove +
          "duration: 1.5\nobjective: {effort: 1, torque_rate: 1e-4}\n"
          "via:\n  - {time: 0.5, q: [0.6, 0.4]}\n  - time: 0.8\n    q: [0.7, 0.4]\n    dq: [0, 0.1]\n",
      "# comment\nstart:\n  q: [0, 0]\ngoal:\n  q:\n    - 1.2\n    - -0.8\nduration: {min: 0.4, max: 2.0}\n"
      "objective: 'gentle'\nlimits: {torque: [10, 4], tip_speed: 3}\nsample_period: 0.002\n"};
  std::mt19937 random(11);
  int read = 0, refused = 0;
  for (int i = 0; i < 6000; ++i) {
    const std::string text = mutated(valid[static_cast<std::size_t>(i) % valid.size()], random);
    try {
      expect_sound(parse(text));
      ++read;
    } catch (const InputError& e) {
      EXPECT_FALSE(e.problem().empty());
      ++refused;
    } catch (const std::exception& e) {
      FAIL() << "round " << i << ": " << e.what() << "\n" << text;
    }
    ASSERT_FALSE(HasFailure()) << "round " << i << "\n" << text;
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 3000);
}

}  // namespace
}  // namespace fjr
