// The exact words with which broken requests are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/planner/parsed_request.h"

namespace fjr {
namespace {

using ::testing::StartsWith;

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
              r.obstacles.discs.push_back({.center = {0.5, nan}, .radius = 0.1});
            }),
            "obstacles[0].center[1]");
  // What contradicts another member.
  EXPECT_EQ(refusal([&](Request& r) { r.goal = JointGoal{}; }), "goal.q");
  EXPECT_EQ(refusal([&](Request& r) { r.duration = FreeDuration{2, 1}; }), "duration");
  EXPECT_EQ(refusal([&](Request& r) { r.way = std::vector{RequestedVia{.time = 0.2, .q = {0.5, 0}}}; }), "via[0].time");
  EXPECT_EQ(refusal([&](Request& r) { r.start.reset(); }), "start");
}

TEST(BrokenRequest, ShapeOfTheDocument) {
  expect_refused({
      {"", "empty"},
      {"# nothing\n", "empty"},
      {std::string("\xff\xfe\0", 3), "is not a text file: it contains zero bytes"},
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

TEST(BrokenRequest, Sets) {
  expect_refused({
      {kStart + "goal: {tip: [0.5, 0.5]}",
       "goal.tip: [0.5, 0.5] m is 0.707107 m from the base; the arm reaches from 0.04 to 0.65 m"},
      {kStart + "goal: {tip: [0.3, -0.4], elbow: up}", "goal.elbow: \"up\" is not one of any, left, right"},
      {kStart + "goal: {tip: [0.3, -0.4], dq: [0, 1]}", "goal.dq: does not go with goal.tip, which decides it"},
      {kStart + "goal: {tip: [0, -0.65], tip_velocity: [1, 0]}",
       "goal.tip_velocity: the stretched or folded arm cannot move its tip this way"},
      {kStart + "goal: {elbow: left}", "goal.elbow: goes with goal.tip"},
      {kStart + "goal: {q: [1, 0], elbow: left}",
       "goal.elbow: goes with goal.tip: goal.q has its elbow on one side already"},
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
      {"start: {q: [-0.11796165109286094, 1.9972420317129205]}\ngoal: {q: [-1.6887579778877575, 1.9972420317129205]}\n"
       "tip: {arc: {center: [0, -0.25], from: [0.25, -0.25], to: [-0.25, -0.25], tolerance: 0.02, way: long}}",
       "tip.arc: is half a turn, which goes either way round; move `to` by a millimetre, to say which"},
      {kStart + "goal: {q: [0, 0]}\npath: {tolerance: 0.01}",
       "path: start and goal are the same; a path between them needs a point"},
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

TEST(BrokenRequest, StartAndGoal) {
  expect_refused({
      {kStart + "goal: {q: [0, 3.4]}", "goal.q[1]: 3.4 rad is outside [-2.6, 2.6]"},
      {"start: {q: [-3.3, 0]}\n" + kGoal, "start.q[0]: -3.3 rad is outside [-3.2, 3.2]"},
      {kMove + "limits: {link_position: [1, 1]}", "goal.q[0]: 1.2 rad is outside [-1, 1]"},
      {kStart + "goal: {q: [0.5, free]}\nlimits: {link_position: [2.6, 0.1], torque: [12, 0.1]}",
       "goal.q: joint 2: holding still takes at least 0.206392 N m, wherever it is, above the limit of 0.1 N m"},
      {kStart + "goal: {q: [1]}", "goal.q: must be two numbers (rad), [joint 1, joint 2], not a list of 1"},
      {kStart + "goal: {q: [1, .nan]}", "goal.q[1]: \".nan\" is not a finite number (rad)"},
      {kStart + "goal: {q: [1, nan]}", "goal.q[1]: \"nan\" is not a finite number (rad)"},
      {kStart + "goal: {q: [1, NaN]}", "goal.q[1]: \"NaN\" is not a finite number (rad)"},
      {kMove + "duration: Infinity", "duration: \"Infinity\" is not a finite number (s)"},
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

// Expects each limit of the list to be refused at `place` when it is half of what this state reaches there. Parts that
// are not known are NaN. Returns the number of limits.
std::size_t expect_limits_checked(const std::string& document, const std::string& place, const State<double>& x) {
  const Parameters robot = load_parameters(kRobot);
  constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
  const Joints<double> not_known{kNotKnown, kNotKnown};
  EXPECT_NO_THROW(resolve(read(document), robot));
  std::size_t known = 0;
  Quantities::visit([&](auto quantity) {
    const auto values = quantity.value(Moment<double>{robot, x, not_known, not_known});
    for (std::size_t j = 0; j < values.size(); ++j) {
      if (std::isnan(values[j])) continue;
      ++known;
      Request request = read(document);
      quantity.info.in(request.limits, j) = 0.5 * quantity.info.magnitude(values[j]);
      try {
        resolve(request, robot);
        ADD_FAILURE() << place << ": " << quantity.info.name << " of index " << j << " was accepted";
      } catch (const InputError& error) {
        EXPECT_THAT(error.field(), StartsWith(place)) << quantity.info.name;
      }
    }
  });
  return known;
}

TEST(BrokenRequest, StatesKeepAllLimitsOfTheList) {
  const std::string moving = "{q: [0.5, 0.4], dq: [1, 1.2], theta: [0.55, 0.42], dtheta: [1.1, 1.3]}";
  State<double> x{{0.5, 0.4}, {1, 1.2}, {0.55, 0.42}, {1.1, 1.3}};
  EXPECT_GE(expect_limits_checked("start: " + moving + "\ngoal: {q: [0, 0]}\n", "start", x), 7U);
  EXPECT_GE(expect_limits_checked("start: {q: [0, 0]}\ngoal: " + moving + "\n", "goal", x), 7U);
  x.theta = x.dtheta = Joints<double>{NAN, NAN};  // a via point says nothing of the motors
  EXPECT_GE(expect_limits_checked("start: {q: [0, 0]}\ngoal: {q: [0, 0], dq: free}\n"
                                  "via: [{q: [0.5, 0.4], dq: [1, 1.2]}]\n",
                                  "via[0]", x),
            3U);
}

TEST(BrokenRequest, DurationAndObjective) {
  expect_refused({
      {kMove + "duration: 0.01", "duration: 0.01 s is outside [0.02, 120]"},
      {kMove + "duration: -1", "duration: -1 s is outside [0.02, 120]"},
      {kMove + "duration: soon", "duration: must be a number (s) or free, not the text \"soon\""},
      {kMove + "duration: fre", "duration: must be a number (s) or free, not the text \"fre\"; did you mean free?"},
      {kStart + "goal: {q: [fre, 1]}",
       "goal.q[0]: must be a number (rad) or free, not the text \"fre\"; did you mean free?"},
      {kStart + "goal: {q: [1, 1], dq: fre}",
       "goal.dq: must be two numbers (rad/s), [joint 1, joint 2], or free, not the text \"fre\"; did you mean free?"},
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
      {kMove + "objective:",
       "objective: must be a preset (fastest, gentle, efficient) or weights {effort: 1, ...}, not empty"},
      {kMove + "objective: [time]",
       "objective: must be a preset (fastest, gentle, efficient) or weights {effort: 1, ...}, not a list of 1"},
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
       "limits.torque: must be two numbers (N m), [joint 1, joint 2], not the number 10"},
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

}  // namespace
}  // namespace fjr
