#include "planner/request/request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include "common/input_error.h"
#include "common/sha256.h"
#include "common/strict_yaml.h"
#include "model/flatness.h"
#include "model/kinematics.h"
#include "planner/problem/inverse_kinematics.h"
#include "planner/problem/problem.h"
#include "planner/request/read_task.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

namespace {

namespace fs = std::filesystem;

constexpr double kShortestPeriod = 0.0005, kLongestPeriod = 0.005;  // [s]
constexpr double kViaSpacing = 1e-3;                                // [s] between vias, and from both ends
constexpr std::size_t kMaxVias = 32;
constexpr double kLargestWeight = 1e9;
constexpr double kSameAngle = 1e-9;  // [rad] below this two given angles mean the same; 1e-5 of an encoder count
constexpr double kNoMotion = 1e-6;   // [rad] as near as two angles of one tip position are computed
constexpr double kLargestLinkVelocity = 100;  // [rad/s] several times what motors and springs together can reach

// ---- keys ----

void check_root_keys(const YamlNode& root) {
  root.allow_keys({"robot", "start", "goal", "duration", "objective", "via", "obstacles", "tip", "path", "limits",
                   "sample_period", "seed", "payload"});
}

// ---- robot, limits ----

Parameters read_robot(const YamlNode& root, const fs::path& folder, const fs::path& default_robot) {
  const auto given = root.find("robot");
  if (!given) return load_parameters(default_robot.empty() ? default_robot_file() : default_robot);
  const fs::path file = folder / given->text();  // an absolute path stays as it is
  std::error_code error;
  if (!fs::is_regular_file(file, error)) given->fail(fmt::format("no such file: {}", shown(file.string())));
  return load_parameters(file);
}

double tightened(const YamlNode& node, double wanted, double robots, std::string_view unit) {
  if (!(wanted > 0)) node.fail(fmt::format("{} must be > 0", with_unit(wanted, unit)));
  if (wanted > robots) {
    node.fail(fmt::format("{} is above the robot's {} (limits may only tighten)", with_unit(wanted, unit),
                          with_unit(robots, unit)));
  }
  return wanted;
}

Limits read_limits(const YamlNode& root, const Parameters& robot) {
  Limits limits = Limits::of(robot);
  const auto given = root.find("limits");
  if (!given) return limits;
  given->allow_keys({"torque", "motor_velocity", "link_position", "spring_deflection", "torque_rate", "tip_speed"});
  visit_pair_limits(limits, [&](std::string_view name, std::string_view unit, Pair<double>& limit) {
    const auto pair = given->find(name);
    if (!pair) return;
    const Pair<double> wanted = pair->pair(unit);
    const std::vector<YamlNode> items = pair->items();
    for (std::size_t j = 0; j < kJoints; ++j) limit[j] = tightened(items[j], wanted[j], limit[j], unit);
  });
  if (const auto speed = given->find("tip_speed")) {
    limits.tip_speed = tightened(*speed, speed->number("m/s"), limits.tip_speed, "m/s");
  }
  return limits;
}

// ---- duration, objective, sampling ----

double read_seconds(const YamlNode& node) {
  const double seconds = node.number("s");
  if (seconds < kShortestDuration || seconds > kLongestDuration) {
    node.fail(fmt::format("{} s is outside [{}, {}]", seconds, kShortestDuration, kLongestDuration));
  }
  return seconds;
}

Duration read_duration(const YamlNode& root) {
  Duration duration{kShortestDuration, kLongestByDefault};
  const auto given = root.find("duration");
  if (!given || given->says("free")) return duration;
  if (given->is_scalar()) {
    duration.min = duration.max = read_seconds(*given);
    return duration;
  }
  if (!given->is_map()) given->fail("must be a number of seconds, free, or {min, max}");
  given->allow_keys({"min", "max"});
  if (const auto min = given->find("min")) duration.min = read_seconds(*min);
  if (const auto max = given->find("max")) {
    duration.max = read_seconds(*max);
  } else if (duration.min > duration.max) {
    duration.max = kLongestDuration;
  }
  if (duration.min > duration.max) {
    given->fail(fmt::format("min {} s is above max {} s", duration.min, duration.max));
  }
  return duration;
}

Weights read_preset(const YamlNode& node, const Duration& duration) {
  const double time = duration.fixed() ? 0 : 1;
  if (node.says("fastest")) {
    if (duration.fixed()) {
      node.fail(
          "fastest has nothing to choose when the duration is fixed; make it free, or choose gentle or efficient");
    }
    return {.time = 1};
  }
  if (node.says("gentle")) return {.time = time, .effort = 0.01, .link_acceleration = 1e-3};
  if (node.says("efficient")) return {.time = time, .effort = 1};
  node.fail(shown(node.text()) +
            " is not a preset (fastest, gentle, efficient); weights are given as {effort: 1, ...}");
}

Weights read_weight_map(const YamlNode& node) {
  Weights weights;
  std::vector<std::string_view> names;
  for (const TermInfo& term : Terms::infos) names.push_back(term.name);
  node.allow_keys(names);
  double sum = 0;
  for (const TermInfo& term : Terms::infos) {
    const auto given = node.find(term.name);
    if (!given) continue;
    const double weight = given->number("1");
    if (weight < 0 || weight > kLargestWeight)
      given->fail(fmt::format("{} is outside [0, {:g}]", weight, kLargestWeight));
    weights.*term.weight = weight;
    sum += weight;
  }
  if (!(sum > 0)) node.fail("at least one weight must be > 0");
  return weights;
}

Weights read_weights(const YamlNode& root, const Duration& duration) {
  const auto given = root.find("objective");
  if (!given) return duration.fixed() ? Weights{.effort = 0.01, .link_acceleration = 1e-3} : Weights{.time = 1};
  if (given->is_scalar()) return read_preset(*given, duration);
  if (!given->is_map()) given->fail("must be a preset (fastest, gentle, efficient) or weights {effort: 1, ...}");
  const Weights weights = read_weight_map(*given);
  if (!duration.fixed() && !(weights.time > 0)) {
    given->fail("a duration that is not fixed needs a time weight; add time: 1, or fix the duration");
  }
  if (duration.fixed() && only_time(weights)) {
    given->fail("time alone has nothing to choose when the duration is fixed; add another weight, such as effort: 1");
  }
  return weights;
}

double read_sample_period(const YamlNode& root, const Duration& duration) {
  const auto given = root.find("sample_period");
  const double period = given ? given->number("s") : Problem{}.sample_period;
  if (period < kShortestPeriod || period > kLongestPeriod) {
    given->fail(fmt::format("{} s is outside [{}, {}]", period, kShortestPeriod, kLongestPeriod));
  }
  // The small amount keeps a duration of 3 periods, 0.003 / 0.001 > 3 in floating point, from counting as 4.
  const double rows = std::ceil(duration.min / period - 1e-9) + 1;
  if (rows > static_cast<double>(kMaxRows)) {
    throw InputError(root.source(), "sample_period",
                     fmt::format("{} s at {} s a row are {} rows, above the {} a trajectory may have; lengthen "
                                 "sample_period",
                                 duration.min, period, rows, kMaxRows));
  }
  return period;
}

// ---- start, goal, via ----

void check_angle(const YamlNode& list, std::size_t j, double angle, const Limits& limits) {
  const double limit = limits.link_position[j];
  if (std::abs(angle) > limit) list.fail_at(j, fmt::format("{} rad is outside [{}, {}]", angle, -limit, limit));
}

Pair<double> read_q(const YamlNode& node, const Limits& limits) {
  const YamlNode list = node.at("q");
  const Pair<double> q = list.pair("rad");
  for (std::size_t j = 0; j < kJoints; ++j) check_angle(list, j, q[j], limits);
  return q;
}

std::optional<Pair<double>> read_optional(const YamlNode& node, std::string_view key, std::string_view unit) {
  const auto given = node.find(key);
  if (!given) return std::nullopt;
  return given->pair(unit);
}

// The robot has no limit on link velocities; this one only keeps the absurd from reaching the arithmetic.
std::optional<Pair<double>> read_dq(const YamlNode& node) {
  const auto dq = read_optional(node, "dq", "rad/s");
  for (std::size_t j = 0; dq && j < kJoints; ++j) {
    if (std::abs((*dq)[j]) > kLargestLinkVelocity) {
      node.at("dq").fail_at(
          j, fmt::format("{} rad/s is outside [{}, {}]", (*dq)[j], -kLargestLinkVelocity, kLargestLinkVelocity));
    }
  }
  return dq;
}

bool is_zero(const Pair<double>& v) { return v[0] == 0 && v[1] == 0; }

bool same_angles(const Pair<double>& a, const Pair<double>& b) {
  return std::abs(a[0] - b[0]) <= kSameAngle && std::abs(a[1] - b[1]) <= kSameAngle;
}

// The first of `keys` that was given: what to name when something derived from it is wrong.
YamlNode given_among(const YamlNode& node, const std::vector<std::string_view>& keys) {
  for (const std::string_view key : keys) {
    if (const auto found = node.find(key)) return *found;
  }
  return node;
}

void check_tip_speed(const YamlNode& node, const Problem& problem, const Pair<double>& q, const Pair<double>& dq) {
  const double speed = std::sqrt(std::max(0.0, tip_speed_squared(problem.robot, q[1], dq)));
  if (!(speed <= problem.limits.tip_speed)) {
    given_among(node, {"dq"})
        .fail(fmt::format("moves the tip at {:.6g} m/s, above the limit of {} m/s", speed, problem.limits.tip_speed));
  }
}

// For messages about what a payload has its share in.
std::string with_load(const Problem& problem) {
  const double mass = problem.robot.payload.mass;
  return mass > 0 ? fmt::format(" with the payload of {} kg", mass) : "";
}

void check_deflection(const YamlNode& node, const Problem& problem, const Pair<double>& q, const Pair<double>& theta) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double deflection = std::abs(theta[j] - q[j]), limit = problem.limits.spring_deflection[j];
    if (!(deflection <= limit)) {
      given_among(node, {"theta", "dq", "q"})
          .fail(fmt::format("joint {}: the spring would be deflected by {:.6g} rad{}, above the limit of {} rad", j + 1,
                            deflection, with_load(problem), limit));
    }
  }
}

void check_motor_velocity(const YamlNode& node, const Problem& problem, const Pair<double>& dtheta) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double speed = std::abs(dtheta[j]), limit = problem.limits.motor_velocity[j];
    if (!(speed <= limit)) {
      given_among(node, {"dtheta", "dq", "q"})
          .fail(fmt::format("joint {}: the motor would turn at {:.6g} rad/s, above the limit of {} rad/s", j + 1, speed,
                            limit));
    }
  }
}

// Resting at q needs G(q) from the motors, without end.
void check_holding(const YamlNode& node, const Problem& problem, const Pair<double>& q) {
  const Pair<double> gravity = gravity_torque(problem.robot, q);
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double torque = std::abs(gravity[j]), limit = problem.limits.torque[j];
    if (!(torque <= limit)) {
      given_among(node, {"q"})
          .fail(fmt::format("joint {}: holding still here takes {:.6g} N m{}, above the limit of {} N m", j + 1, torque,
                            with_load(problem), limit));
    }
  }
}

// With a free joint some of its angles has to do.
void check_holding_somewhere(const YamlNode& node, const Problem& problem, const Goal& goal) {
  constexpr int kAngles = 2000;
  const std::size_t free = goal.free[0] ? 0 : 1, given = 1 - free;
  Pair<double> q = goal.q;
  double least = kNoLimit;  // [N m] of the joint that is given
  for (int i = 0; i <= kAngles; ++i) {
    q[free] = std::lerp(-1.0, 1.0, i / double{kAngles}) * problem.limits.link_position[free];
    const Pair<double> gravity = gravity_torque(problem.robot, q);
    if (std::abs(gravity[free]) <= problem.limits.torque[free]) least = std::min(least, std::abs(gravity[given]));
  }
  if (least <= problem.limits.torque[given]) return;
  node.at("q").fail(
      fmt::format("joint {}: holding still here takes at least {:.6g} N m{}, wherever joint {} is, above "
                  "the limit of {} N m",
                  given + 1, least, with_load(problem), free + 1, problem.limits.torque[given]));
}

void read_start(const YamlNode& node, Problem& problem) {
  node.allow_keys({"q", "dq", "theta", "dtheta"});
  const Pair<double> q = read_q(node, problem.limits);
  const Pair<double> dq = read_dq(node).value_or(Pair<double>{});
  const State<double> rest = rest_at(problem.robot, q);
  // At rest flatness gives the same but for rounding, and rest should be rest exactly.
  State<double> start = is_zero(dq) ? rest : from_link_motion(problem.robot, {.q = q, .dq = dq}).state;
  if (const auto theta = read_optional(node, "theta", "rad")) start.theta = *theta;
  if (const auto dtheta = read_optional(node, "dtheta", "rad/s")) start.dtheta = *dtheta;
  problem.start = start;
  problem.start_at_rest = is_zero(start.dq) && is_zero(start.dtheta) && same_angles(start.theta, rest.theta);
  check_tip_speed(node, problem, q, start.dq);
  check_deflection(node, problem, q, start.theta);
  check_motor_velocity(node, problem, start.dtheta);
  if (problem.start_at_rest) check_holding(node, problem, q);
}

// What the goal asks of the motors; nothing given with a moving goal leaves them free.
void resolve_goal_motors(const YamlNode& node, const Problem& problem, Goal& goal) {
  goal.theta = read_optional(node, "theta", "rad");
  goal.dtheta = read_optional(node, "dtheta", "rad/s");
  if (goal.dq_free) {
    goal.at_rest = false;
    return;
  }
  const State<double> rest = rest_at(problem.robot, goal.q);
  const bool plain_stop = is_zero(goal.dq) && !goal.theta && !goal.dtheta;
  const bool spelled_out =
      is_zero(goal.dq) && goal.theta && goal.dtheta && is_zero(*goal.dtheta) && same_angles(*goal.theta, rest.theta);
  goal.at_rest = plain_stop || spelled_out;
  if (!goal.at_rest) return;
  if (!goal.any_free()) goal.theta = rest.theta;
  goal.dtheta = rest.dtheta;
}

void check_goal(const YamlNode& node, const Problem& problem, const Goal& goal) {
  check_tip_speed(node, problem, goal.q, goal.dq);
  if (goal.theta) check_deflection(node, problem, goal.q, *goal.theta);
  if (goal.dtheta) check_motor_velocity(node, problem, *goal.dtheta);
  if (!goal.at_rest) return;
  goal.any_free() ? check_holding_somewhere(node, problem, goal) : check_holding(node, problem, goal.q);
}

// Angles, each of which may be `free`: a guess then keeps the start's.
void read_goal_angles(const YamlNode& node, const Problem& problem, Goal& goal) {
  const YamlNode list = node.at("q");
  const std::vector<YamlNode> items = list.is_list() ? list.items() : std::vector<YamlNode>{};
  if (items.size() != kJoints || !(items[0].says("free") || items[1].says("free"))) {
    goal.q = read_q(node, problem.limits);
    return;
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    goal.free[j] = items[j].says("free");
    goal.q[j] = goal.free[j] ? problem.start.q[j] : items[j].number("rad");
    check_angle(list, j, goal.q[j], problem.limits);
  }
  if (goal.free[0] && goal.free[1]) list.fail("one joint may be free, not both");
  for (const std::string_view key : {"theta", "dtheta"}) {
    if (const auto given = node.find(key)) given->fail("has no meaning beside a free joint");
  }
}

void read_joint_goal(const YamlNode& node, Problem& problem) {
  for (const std::string_view key : {"elbow", "tip_velocity"}) {
    if (const auto given = node.find(key)) given->fail("goes with goal.tip; with goal.q give dq");
  }
  Goal& goal = problem.goal;
  read_goal_angles(node, problem, goal);
  const auto given_dq = node.find("dq");
  goal.dq_free = given_dq && given_dq->says("free");
  const auto dq = goal.dq_free ? Pair<double>{} : read_dq(node);
  if (!dq || goal.dq_free) {
    for (const std::string_view key : {"theta", "dtheta"}) {
      if (const auto given = node.find(key)) {
        given->fail(goal.dq_free
                        ? "does not go with goal.dq: free, which leaves the motors free"
                        : "needs goal.dq beside it; without goal.dq the arm ends at rest and the motors with it");
      }
    }
  }
  goal.dq = dq.value_or(Pair<double>{});
  resolve_goal_motors(node, problem, goal);
  check_goal(node, problem, goal);
}

Elbow read_elbow(const YamlNode& node) {
  const auto given = node.find("elbow");
  if (!given || given->says("any")) return Elbow::kAny;
  if (given->says("left")) return Elbow::kLeft;
  if (given->says("right")) return Elbow::kRight;
  given->fail(shown(given->text()) + " is not one of any, left, right");
}

// The goal at q; none, and `why`, when the arm cannot be there.
std::optional<Goal> tip_goal(const YamlNode& node, const Problem& problem, const Pair<double>& q,
                             const std::optional<Pair<double>>& velocity, std::optional<InputError>& why) {
  Goal goal;
  goal.q = q;
  try {
    if (velocity) {
      const auto dq = inverse_velocity(problem.robot, q, *velocity);
      if (!dq) node.at("tip_velocity").fail("the stretched or folded arm cannot move its tip this way");
      goal.dq = *dq;
      for (const double rate : goal.dq) {
        if (std::abs(rate) > kLargestLinkVelocity) {
          node.at("tip_velocity")
              .fail(fmt::format("takes a joint velocity of {:.4g} rad/s, above {} rad/s", rate, kLargestLinkVelocity));
        }
      }
    }
    resolve_goal_motors(node, problem, goal);
    check_goal(node, problem, goal);
    return goal;
  } catch (const InputError& error) {
    if (!why) why = error;
    return std::nullopt;
  }
}

// A tip position is a set of goals: one for each elbow, and for each turn within the limits.
void read_tip_goal(const YamlNode& node, Problem& problem) {
  for (const std::string_view key : {"q", "dq", "theta", "dtheta"}) {
    if (const auto given = node.find(key)) given->fail("does not go with goal.tip, which decides it");
  }
  const YamlNode given = node.at("tip");
  const Pair<double> tip = given.pair("m"), within = reach(problem.robot);
  const double away = std::hypot(tip[0], tip[1]);
  if (!(away >= within[0] - kSameAngle && away <= within[1] + kSameAngle)) {  // as near in metres
    given.fail(fmt::format("[{}, {}] m is {:.6g} m from the base; the arm reaches from {:.6g} to {:.6g} m", tip[0],
                           tip[1], away, within[0], within[1]));
  }
  const Elbow elbow = read_elbow(node);
  const auto velocity = read_optional(node, "tip_velocity", "m/s");
  std::optional<InputError> why;
  std::vector<Goal> goals;
  for (const Pair<double>& q :
       inverse_kinematics(problem.robot, tip, elbow, problem.limits.link_position, problem.start.q)) {
    if (const auto goal = tip_goal(node, problem, q, velocity, why)) goals.push_back(*goal);
  }
  if (goals.empty() && why) throw InputError(*why);
  if (goals.empty()) {
    given.fail(fmt::format("[{}, {}] m takes a joint beyond its limits of {} and {} rad{}", tip[0], tip[1],
                           problem.limits.link_position[0], problem.limits.link_position[1],
                           elbow == Elbow::kAny ? "" : "; the other elbow may do"));
  }
  problem.goal = goals.front();
  problem.other_goals.assign(goals.begin() + 1, goals.end());
}

void read_goal(const YamlNode& node, Problem& problem) {
  node.allow_keys({"q", "dq", "theta", "dtheta", "tip", "elbow", "tip_velocity"});
  node.find("tip") ? read_tip_goal(node, problem) : read_joint_goal(node, problem);
}

std::optional<double> read_via_time(const YamlNode& node, double after, const Duration& duration) {
  const auto given = node.find("time");
  if (!given) return std::nullopt;
  if (!duration.fixed()) given->fail("needs a fixed duration; without one a via point is passed at any time");
  const double time = given->number("s");
  const double spacing = kViaSpacing * (1 - 1e-9);  // so that 0.301 counts as 0.001 after 0.3
  if (time - after < spacing || duration.max - time < spacing) {
    given->fail(fmt::format("{} s must lie between {} s and {} s, at least {} s from both", time, after, duration.max,
                            kViaSpacing));
  }
  return time;
}

Via read_via(const YamlNode& node, const Problem& problem) {
  node.allow_keys({"time", "q", "dq", "release"});
  double after = 0;
  for (const Via& via : problem.via) after = via.time.value_or(after + kViaSpacing);
  Via via;
  via.time = read_via_time(node, after, problem.duration);
  via.q = read_q(node, problem.limits);
  via.dq = read_dq(node);
  if (via.dq) check_tip_speed(node, problem, via.q, *via.dq);
  return via;
}

// A link goes no further than its motor at full speed, and the spring from one end of its range to the other.
void check_via_times(const std::vector<YamlNode>& items, const Problem& problem) {
  double time = 0;
  Pair<double> q = problem.start.q;
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const Via& via = problem.via[i];
    if (!via.time) continue;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double away = std::abs(via.q[j] - q[j]), speed = problem.limits.motor_velocity[j];
      const double most = speed * (*via.time - time) + 2 * problem.limits.spring_deflection[j];
      if (away <= most) continue;
      items[i].at("time").fail(
          fmt::format("joint {}: {:.6g} rad in {:.6g} s from the time before; at {} rad/s of the motor, and with the "
                      "spring's deflection, at most {:.6g} rad are possible",
                      j + 1, away, *via.time - time, speed, most));
    }
    time = *via.time;
    q = via.q;
  }
}

void read_vias(const YamlNode& root, Problem& problem) {
  const auto given = root.find("via");
  if (!given) return;
  const std::vector<YamlNode> items = given->items();
  if (items.size() > kMaxVias) given->fail(fmt::format("{} points, above the {} allowed", items.size(), kMaxVias));
  for (const YamlNode& item : items) problem.via.push_back(read_via(item, problem));
  check_via_times(items, problem);
}

// Those before a given time were checked with it.
void check_time_left(const YamlNode& root, const Problem& problem) {
  double last = 0;
  std::size_t after = 0;
  for (const Via& via : problem.via) {
    after = via.time ? 0 : after + 1;
    last = via.time.value_or(last);
  }
  const double left = problem.duration.max - last, needed = static_cast<double>(after + 1) * kViaSpacing * (1 - 1e-9);
  if (left >= needed) return;
  root.at(problem.task.path ? "path" : "via")
      .fail(fmt::format("{} points after {} s leave no time until the end at {} s, at least {} s apart", after, last,
                        problem.duration.max, kViaSpacing));
}

bool is_release(const YamlNode& via) {
  const auto given = via.find("release");
  if (given && !given->says("true") && !given->says("false")) given->fail("must be true or false");
  return given && given->says("true");
}

// What is thrown is let go where a via point says so; otherwise at the goal if the arm moves there, and at the last via
// point if it does not.
void read_release(const YamlNode& root, Problem& problem) {
  const auto vias = root.find("via");
  const std::vector<YamlNode> items = vias ? vias->items() : std::vector<YamlNode>{};
  if (problem.goal.at_rest && !items.empty()) problem.release = items.size() - 1;
  bool said = false;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!is_release(items[i])) continue;
    if (said) items[i].at("release").fail("is said of another via point already");
    said = true;
    problem.release = i;
  }
  if (problem.weights.tip_speed > 0 && !problem.release && problem.goal.at_rest) {
    root.at("objective")
        .at("tip_speed")
        .fail("the arm moves nowhere that is named: needs a via point, or a moving goal");
  }
}

// With a fixed duration, staying where one is can be meant; otherwise it takes no time at all.
void refuse_empty_motion(const YamlNode& root, const Problem& problem) {
  if (problem.duration.fixed() || !problem.start_at_rest || !problem.goal.at_rest || !problem.via.empty()) return;
  bool same = true;
  for (std::size_t j = 0; j < kJoints; ++j) {
    same = same && (problem.goal.free[j] || std::abs(problem.start.q[j] - problem.goal.q[j]) <= kNoMotion);
  }
  if (same) root.at("goal").fail("start and goal are the same state; nothing to plan");
}

// ---- hash ----

// "name=value" lines of everything that decides the plan.
class HashLines {
 public:
  void add(const std::string& name, double value) {
    lines_.push_back(fmt::format("{}={:.17g}\n", name, value + 0.0));  // -0 is 0
  }
  void add(const std::string& name, const Pair<double>& pair) {
    for (std::size_t j = 0; j < kJoints; ++j) add(fmt::format("{}[{}]", name, j), pair[j]);
  }
  void add(const std::string& name, const std::optional<Pair<double>>& pair) {
    pair ? add(name, *pair) : add_text(name, "free");
  }
  void add_text(const std::string& name, std::string_view text) {
    lines_.push_back(fmt::format("{}={}\n", name, text));
  }

  std::string hash() {
    std::sort(lines_.begin(), lines_.end());
    return sha256_hex(fmt::format("{}", fmt::join(lines_, "")));
  }

 private:
  std::vector<std::string> lines_;
};

void add_goal(HashLines& lines, const std::string& name, const Goal& goal) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const std::string angle = fmt::format("{}.q[{}]", name, j);
    goal.free[j] ? lines.add_text(angle, "free") : lines.add(angle, goal.q[j]);
  }
  goal.dq_free ? lines.add_text(name + ".dq", "free") : lines.add(name + ".dq", goal.dq);
  lines.add(name + ".theta", goal.theta);
  lines.add(name + ".dtheta", goal.dtheta);
}

void add_states(HashLines& lines, const Problem& problem) {
  lines.add("start.q", problem.start.q);
  lines.add("start.dq", problem.start.dq);
  lines.add("start.theta", problem.start.theta);
  lines.add("start.dtheta", problem.start.dtheta);
  add_goal(lines, "goal", problem.goal);
  for (std::size_t i = 0; i < problem.other_goals.size(); ++i) {
    add_goal(lines, fmt::format("other_goals[{}]", i), problem.other_goals[i]);
  }
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const Via& via = problem.via[i];
    const std::string name = fmt::format("via[{}]", i);
    via.time ? lines.add(name + ".time", *via.time) : lines.add_text(name + ".time", "free");
    lines.add(name + ".q", via.q);
    lines.add(name + ".dq", via.dq);
    if (via.tolerance > 0) lines.add(name + ".tolerance", via.tolerance);
  }
}

// The rows say all there is to say about a task.
void add_task(HashLines& lines, const Problem& problem) {
  for (std::size_t s = 0; s <= problem.via.size(); ++s) {
    const std::vector<TaskRow> rows = task_rows(problem.robot, problem.task, s);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::string name = fmt::format("task[{}][{}]", s, r);
      lines.add_text(name + ".kind", fmt::format("{} {}", rows[r].name, static_cast<int>(rows[r].kind)));
      lines.add(name + ".vector", rows[r].vector);
      lines.add(name + ".number", rows[r].number);
      lines.add(name + ".lower", rows[r].lower);
      lines.add(name + ".upper", rows[r].upper);
    }
  }
}

std::string request_hash(const Problem& problem) {
  HashLines lines;
  lines.add_text("robot_hash", robot_hash(problem.robot));
  add_states(lines, problem);
  add_task(lines, problem);
  visit_pair_limits(problem.limits, [&](std::string_view name, std::string_view, const Pair<double>& limit) {
    lines.add(fmt::format("limits.{}", name), limit);
  });
  lines.add("limits.tip_speed", problem.limits.tip_speed);
  lines.add("duration.min", problem.duration.min);
  lines.add("duration.max", problem.duration.max);
  for (const TermInfo& term : Terms::infos) {
    lines.add(fmt::format("objective.{}", term.name), problem.weights.*term.weight);
  }
  if (problem.release) lines.add("release", static_cast<double>(*problem.release));
  lines.add("sample_period", problem.sample_period);
  lines.add_text("seed", std::to_string(problem.seed));
  return lines.hash();
}

YamlNode given_start(const YamlNode& root) {
  if (const auto start = root.find("start")) return *start;
  throw InputError(root.source(), "start",
                   "missing; only a request to the service may leave it out, which then starts where the arm rests");
}

Problem resolve(const YamlNode& root, const Parameters& robot) {
  Problem problem;
  problem.name = fs::path(root.source()).stem().string();
  problem.robot = robot;
  if (const auto payload = root.find("payload")) problem.robot.payload = read_payload(*payload);
  problem.limits = read_limits(root, problem.robot);
  problem.duration = read_duration(root);
  problem.weights = read_weights(root, problem.duration);
  problem.sample_period = read_sample_period(root, problem.duration);
  if (const auto seed = root.find("seed")) problem.seed = seed->whole_number();
  read_start(given_start(root), problem);
  read_goal(root.at("goal"), problem);
  read_vias(root, problem);
  read_release(root, problem);
  read_task(root, problem);
  check_time_left(root, problem);
  check_task(root, problem);
  refuse_empty_motion(root, problem);
  problem.request_hash = request_hash(problem);
  return problem;
}

}  // namespace

Problem load_request(const fs::path& file, const fs::path& default_robot) {
  const YamlNode root = YamlNode::load(file);
  check_root_keys(root);
  return resolve(root, read_robot(root, file.parent_path(), default_robot));
}

Problem parse_request(const std::string& yaml, const std::string& source, const fs::path& folder,
                      const fs::path& default_robot) {
  const YamlNode root = YamlNode::parse(yaml, source);
  check_root_keys(root);
  return resolve(root, read_robot(root, folder, default_robot));
}

Problem parse_request(const std::string& yaml, const std::string& source, const Parameters& robot) {
  const YamlNode root = YamlNode::parse(yaml, source);
  check_root_keys(root);
  if (const auto named = root.find("robot")) named->fail("the robot is given already");
  return resolve(root, robot);
}

}  // namespace fjr
