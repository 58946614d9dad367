// Resolves a Request to a Problem: values become numbers, and what contradicts itself or the robot is refused.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "common/input_error.h"
#include "common/spelling.h"
#include "model/flatness.h"
#include "model/kinematics.h"
#include "model/uncertainty.h"
#include "planner/collocation/scheme.h"
#include "planner/problem/inverse_kinematics.h"
#include "planner/request/check_state.h"
#include "planner/request/place.h"
#include "planner/request/request.h"
#include "planner/request/request_keys.h"
#include "planner/request/resolve_task.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

constexpr double kShortestPeriod = 0.0005;  // [s] between rows
constexpr double kLargestWeight = 1e9;
constexpr const char* kNothingUncertain =
    "the robot has neither covariance nor standard errors, and the payload none: nothing is uncertain";
constexpr double kSameAngle = 1e-9;  // [rad] below this two given angles mean the same; 1e-5 of an encoder count
constexpr double kSamePlace = 1e-9;  // [m] likewise
constexpr double kNoMotion = 1e-6;   // [rad] accuracy of the angles computed for a tip position
constexpr double kLargestLinkVelocity = 100;  // [rad/s] several times what motors and springs together can reach

// ---- limits ----

double tightened(const Place& place, double wanted, double robots, std::string_view unit) {
  if (!(wanted > 0)) place.fail(fmt::format("{} must be > 0", with_unit(wanted, unit)));
  if (wanted > robots) {
    place.fail(fmt::format("{} is above the robot's {} (limits may only tighten){}", with_unit(wanted, unit),
                           with_unit(robots, unit), unit == "rad" ? degrees_suspected(wanted, 0, robots) : ""));
  }
  return wanted;
}

Limits resolve_limits(const Request& request, const Parameters& robot) {
  const Place place{request, "limits"};
  Limits limits = Limits::of(robot);
  for (const LimitName& name : kLimitNames) {
    const double asked = name.in(request.limits);
    if (asked == kNoLimit) continue;
    const Place of_quantity = place.at(name.quantity->name);
    double& limit = name.in(limits);
    limit = tightened(name.joint == 0 ? of_quantity : of_quantity.at(name.j()), asked, limit, name.quantity->unit);
  }
  return limits;
}

// Checks a payload that came as numbers over DDS and was not checked while a document was read.
void check_payload(const Request& request) {
  const Place place{request, "payload"};
  kPayloadMassBound.check(place.at("mass"), request.payload->mass);
  kPayloadInertiaBound.check(place.at("inertia"), request.payload->inertia);
}

// ---- duration, objective, sampling ----

double checked_seconds(const Place& place, double seconds) {
  if (seconds < kShortestDuration || seconds > kLongestDuration) {
    place.fail(fmt::format("{} s is outside [{}, {}]", seconds, kShortestDuration, kLongestDuration));
  }
  return seconds;
}

Duration resolve_duration(const Request& request) {
  const Place place{request, "duration"};
  if (const auto* fixed = std::get_if<double>(&request.duration)) {
    const double seconds = checked_seconds(place, *fixed);
    return {seconds, seconds};
  }
  Duration duration{kShortestDuration, kLongestByDefault};
  const auto& [min, max] = std::get<FreeDuration>(request.duration);
  if (min) duration.min = checked_seconds(place.at("min"), *min);
  if (max) duration.max = checked_seconds(place.at("max"), *max);
  if (!max && duration.min >= duration.max) duration.max = kLongestDuration;
  if (duration.min > duration.max) {
    place.fail(fmt::format("min {} s is above max {} s", duration.min, duration.max));
  }
  return duration;
}

}  // namespace

Preset default_preset(const Duration& duration) { return duration.fixed() ? Preset::kGentle : Preset::kFastest; }

namespace {

Weights weights_of(const Place& place, Preset preset, const Duration& duration) {
  const double time = duration.fixed() ? 0 : 1;
  switch (preset) {
    case Preset::kFastest:
      break;
    case Preset::kGentle:
      return {.time = time, .effort = 0.01, .link_acceleration = 1e-3};
    case Preset::kEfficient:
      return {.time = time, .effort = 1};
  }
  if (duration.fixed()) {
    place.fail("fastest has nothing to choose when the duration is fixed; make it free, or choose gentle or efficient");
  }
  return {.time = 1};
}

Weights checked_weights(const Place& place, const Weights& weights) {
  double sum = 0;
  for (const TermInfo& term : Terms::infos) {
    const double weight = weights.*term.weight;
    if (weight < 0 || weight > kLargestWeight) {
      place.at(term.name).fail(fmt::format("{} is outside [0, {:g}]", weight, kLargestWeight));
    }
    sum += weight;
  }
  if (!(sum > 0)) place.fail("at least one weight must be > 0");
  return weights;
}

Weights resolve_weights(const Request& request, const Parameters& robot, const Duration& duration) {
  const Place place{request, "objective"};
  if (!request.objective) return weights_of(place, default_preset(duration), duration);
  if (const auto* preset = std::get_if<Preset>(&*request.objective)) return weights_of(place, *preset, duration);
  const Weights all = checked_weights(place, std::get<Weights>(*request.objective));
  if (all.tracking > 0 && uncertainty_of(robot).none()) place.at("tracking").fail(kNothingUncertain);
  const Weights weights = without_closed_loop(all);
  if (objective_scale(weights) == 0) {
    place.at("tracking")
        .fail("needs another term beside it, which says what it is traded for; add time: 1 or effort: 1");
  }
  if (!duration.fixed() && !(weights.time > 0)) {
    place.fail("a duration that is not fixed needs a time weight; add time: 1, or fix the duration");
  }
  if (duration.fixed() && only_time(weights)) {
    place.fail("time alone has nothing to choose when the duration is fixed; add another weight, such as effort: 1");
  }
  return all;
}

double resolve_sample_period(const Request& request, const Duration& duration) {
  const Place place{request, "sample_period"};
  const double period = *request.sample_period;
  if (period < kShortestPeriod || period > kLongestSamplePeriod) {
    place.fail(fmt::format("{} s is outside [{}, {}]", period, kShortestPeriod, kLongestSamplePeriod));
  }
  // The small amount keeps a duration of 3 periods, 0.003 / 0.001 > 3 in floating point, from counting as 4.
  const double rows = std::ceil(duration.min / period - 1e-9) + 1;
  if (rows > static_cast<double>(kMaxRows)) {
    place.fail(
        fmt::format("{} s at {} s a row are {} rows, above the {} a trajectory may have; lengthen "
                    "sample_period",
                    duration.min, period, rows, kMaxRows));
  }
  return period;
}

std::string resolve_method(const Request& request) {
  const std::string method = request.method.value_or(kDefaultMethod);
  const std::vector<Scheme> schemes = all_schemes();
  std::vector<std::string_view> known;
  for (const Scheme& scheme : schemes) known.emplace_back(scheme.name);
  if (std::find(known.begin(), known.end(), method) != known.end()) return method;
  Place{request, "method"}.fail(
      fmt::format("{} is not one of {}{}", shown(method), fmt::join(known, ", "), did_you_mean(method, known)));
}

// ---- start, goal, via ----

void check_angle(const Place& angles, std::size_t j, double angle, const Limits& limits) {
  check_angle(angles.at(j), angle, limits.lowest(j), limits.highest(j));
}

Joints<double> checked_angles(const Place& state, const Joints<double>& q, const Limits& limits) {
  for (std::size_t j = 0; j < kJoints; ++j) check_angle(state.at("q"), j, q[j], limits);
  return q;
}

// The robot has no limit on link velocities; this one only keeps the absurd from reaching the arithmetic.
Joints<double> checked_velocity(const Place& state, const Joints<double>& dq) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (std::abs(dq[j]) > kLargestLinkVelocity) {
      state.at("dq").at(j).fail(
          fmt::format("{} rad/s is outside [{}, {}]", dq[j], -kLargestLinkVelocity, kLargestLinkVelocity));
    }
  }
  return dq;
}

bool is_zero(const Joints<double>& v) { return v[0] == 0 && v[1] == 0; }

bool same_angles(const Joints<double>& a, const Joints<double>& b) {
  return std::abs(a[0] - b[0]) <= kSameAngle && std::abs(a[1] - b[1]) <= kSameAngle;
}

void resolve_start(const Request& request, Problem& problem) {
  const Place place{request, "start"};
  if (!request.start) {
    place.fail("missing; only a request to the service may leave it out, which then starts where the arm rests");
  }
  const RequestedStart& start = *request.start;
  const StatePlace state{place, true, start.dq.has_value(), start.theta.has_value(), start.dtheta.has_value()};
  const Joints<double> q = checked_angles(place, start.q, problem.limits);
  const Joints<double> dq = checked_velocity(place, start.dq.value_or(Joints<double>{}));
  const State<double> rest = rest_at(problem.robot, q);
  // At rest flatness gives the same except for rounding, but velocities should be exactly zero.
  problem.start = is_zero(dq) ? rest : from_link_motion(problem.robot, {.q = q, .dq = dq}).state;
  if (start.theta) problem.start.theta = *start.theta;
  if (start.dtheta) problem.start.dtheta = *start.dtheta;
  problem.start_at_rest =
      is_zero(problem.start.dq) && is_zero(problem.start.dtheta) && same_angles(problem.start.theta, rest.theta);
  const State<double>& known = problem.start;
  check_state(state, problem, {known.q, known.dq, known.theta, known.dtheta, problem.start_at_rest});
}

// Decides whether the goal is at rest, and sets the motors accordingly.
void settle_goal(const Problem& problem, Goal& goal) {
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

// Checks the goal against the limits. The angle of a free joint is that of its guess.
void check_goal(const StatePlace& place, const Problem& problem, const Goal& goal) {
  KnownState known{goal.q, goal.dq, goal.theta, goal.dtheta, goal.at_rest && !goal.any_free()};
  if (goal.dq_free) known.dq.reset();
  check_state(place, problem, known);
  if (goal.at_rest && goal.any_free()) check_holding_somewhere(place.place, problem, goal);
}

// Resolves the angles of the goal. The guess of a free joint is its angle at the start.
void resolve_goal_angles(const Place& place, const AnglesOrFree& asked, const Problem& problem, Goal& goal) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    goal.free[j] = !asked[j];
    goal.q[j] = asked[j].value_or(problem.start.q[j]);
    check_angle(place.at("q"), j, goal.q[j], problem.limits);
  }
  if (goal.free[0] && goal.free[1]) place.at("q").fail("one joint may be free, not both");
}

// Resolves the velocities of the goal. What is not given is free.
void resolve_goal_velocity(const Place& place, const Moving& asked, Goal& goal) {
  const Place motors = place.first_of({{"theta", asked.theta.has_value()}, {"dtheta", asked.dtheta.has_value()}});
  if (goal.any_free() && motors.field != place.field) motors.fail("has no meaning beside a free joint");
  goal.dq = checked_velocity(place, asked.dq);
  goal.theta = asked.theta;
  goal.dtheta = asked.dtheta;
}

void resolve_joint_goal(const Request& request, const JointGoal& asked, Problem& problem) {
  const Place place{request, "goal"};
  Goal& goal = problem.goal;
  resolve_goal_angles(place, asked.q, problem, goal);
  goal.dq_free = std::holds_alternative<AnyVelocity>(asked.arrival);
  const auto* moving = std::get_if<Moving>(&asked.arrival);
  if (moving != nullptr) resolve_goal_velocity(place, *moving, goal);
  settle_goal(problem, goal);
  check_goal({place, true, moving != nullptr, moving != nullptr && moving->theta, moving != nullptr && moving->dtheta},
             problem, goal);
}

// Returns the goal at q, or nothing and the reason in `why` if the arm cannot be there.
std::optional<Goal> tip_goal(const Request& request, const TipGoal& asked, const Problem& problem,
                             const Joints<double>& q, std::optional<InputError>& why) {
  const Place place{request, "goal"};
  Goal goal;
  goal.q = q;
  try {
    if (asked.velocity) {
      const bool rests = *asked.velocity == Joints<double>{};  // which every arm can do, stretched or not
      const auto dq = rests ? Joints<double>{} : inverse_velocity(problem.robot, q, *asked.velocity);
      if (!dq) place.at("tip_velocity").fail("the stretched or folded arm cannot move its tip this way");
      goal.dq = *dq;
      goal.of_tip_velocity = true;
      for (const double rate : goal.dq) {
        if (std::abs(rate) > kLargestLinkVelocity) {
          place.at("tip_velocity")
              .fail(fmt::format("takes a joint velocity of {:.4g} rad/s, above {} rad/s", rate, kLargestLinkVelocity));
        }
      }
    }
    settle_goal(problem, goal);
    check_goal({place}, problem, goal);
    return goal;
  } catch (const InputError& error) {
    if (!why) why = error;
    return std::nullopt;
  }
}

void check_reach(const Place& place, const Parameters& robot, const Joints<double>& tip) {
  const Joints<double> within = reach(robot);
  const double away = std::hypot(tip[0], tip[1]);
  if (away >= within[0] - kSamePlace && away <= within[1] + kSamePlace) return;
  place.fail(fmt::format("[{}, {}] m is {:.6g} m from the base; the arm reaches from {:.6g} to {:.6g} m", tip[0],
                         tip[1], away, within[0], within[1]));
}

// A tip position is a set of goals: one for each elbow, and for each turn within the limits.
void resolve_tip_goal(const Request& request, const TipGoal& asked, Problem& problem) {
  const Place place{request, "goal"};
  const Coordinates& tip = asked.tip;
  check_reach(place.at("tip"), problem.robot, tip);
  std::optional<InputError> why;
  std::vector<Goal> goals;
  for (const Joints<double>& q : inverse_kinematics(problem.robot, tip, asked.elbow, problem.limits, problem.start.q)) {
    if (const auto goal = tip_goal(request, asked, problem, q, why)) goals.push_back(*goal);
  }
  if (goals.empty() && why) throw InputError(*why);
  if (goals.empty()) {
    const auto range = [&](std::size_t j) {
      const Limits& limits = problem.limits;
      return limits.link_middle[j] == 0 ? fmt::format("{}", limits.link_position[j])
                                        : fmt::format("[{}, {}]", limits.lowest(j), limits.highest(j));
    };
    place.at("tip").fail(fmt::format("[{}, {}] m takes a joint beyond its limits of {} and {} rad{}", tip[0], tip[1],
                                     range(0), range(1), asked.elbow == Elbow::kAny ? "" : "; the other elbow may do"));
  }
  problem.goal = goals.front();
  problem.other_goals.assign(goals.begin() + 1, goals.end());
}

void check_via_time(const Place& place, double time, double after, const Duration& duration) {
  if (!duration.fixed()) place.fail("needs a fixed duration; without one a via point is passed at any time");
  const double spacing = kShortestSegment * (1 - 1e-9);  // with rounding, 0.301 has to count as 0.001 after 0.3
  if (time - after < spacing || duration.max - time < spacing) {
    place.fail(fmt::format("{} s must lie between {} s and {} s, at least {} s from both", time, after, duration.max,
                           kShortestSegment));
  }
}

Via resolve_via(const Place& place, const RequestedVia& asked, const Problem& problem) {
  double after = 0;
  for (const Via& via : problem.via) after = via.time.value_or(after + kShortestSegment);
  Via via;
  if (asked.time) check_via_time(place.at("time"), *asked.time, after, problem.duration);
  via.time = asked.time;
  via.q = checked_angles(place, asked.q, problem.limits);
  if (asked.dq) via.dq = checked_velocity(place, *asked.dq);
  check_state({place, true, asked.dq.has_value()}, problem, {via.q, via.dq});
  return via;
}

// Refuses via times that are too early: a link moves no further than its motor at full speed, plus the spring from one
// end of its range to the other.
void check_via_times(const Place& vias, const Problem& problem) {
  double time = 0;
  Joints<double> q = problem.start.q;
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const Via& via = problem.via[i];
    if (!via.time) continue;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double away = std::abs(via.q[j] - q[j]), speed = problem.limits.motor_velocity[j];
      const double most = speed * (*via.time - time) + 2 * problem.limits.spring_deflection[j];
      if (away <= most) continue;
      vias.at(i).at("time").fail(
          fmt::format("joint {}: {:.6g} rad in {:.6g} s from the time before; at {} rad/s of the motor, and with the "
                      "spring's deflection, at most {:.6g} rad are possible",
                      j + 1, away, *via.time - time, speed, most));
    }
    time = *via.time;
    q = via.q;
  }
}

void resolve_vias(const Request& request, const std::vector<RequestedVia>& asked, Problem& problem) {
  const Place place{request, "via"};
  if (asked.size() > kMostVias) {
    place.fail(fmt::format("{} points, above the {} allowed", asked.size(), kMostVias));
  }
  for (std::size_t i = 0; i < asked.size(); ++i) {
    problem.via.push_back(resolve_via(place.at(i), asked[i], problem));
  }
  check_via_times(place, problem);
}

// Checks the time after the last via point with a given time; those before it were checked already.
void check_time_left(const Request& request, const Problem& problem) {
  double last = 0;
  std::size_t after = 0;
  for (const Via& via : problem.via) {
    after = via.time ? 0 : after + 1;
    last = via.time.value_or(last);
  }
  const double left = problem.duration.max - last,
               needed = static_cast<double>(after + 1) * kShortestSegment * (1 - 1e-9);
  if (left >= needed) return;
  Place{request, problem.task.path ? "path" : "via"}.fail(
      fmt::format("{} points after {} s leave no time until the end at {} s, at least {} s apart", after, last,
                  problem.duration.max, kShortestSegment));
}

// Decides where a thrown object is released: at the via point that says so; otherwise at the goal if the arm moves
// there, and at the last via point if it does not.
void resolve_release(const Request& request, Problem& problem) {
  if (const auto* vias = std::get_if<std::vector<RequestedVia>>(&request.way)) {
    if (problem.goal.at_rest && !vias->empty()) problem.release = vias->size() - 1;
    bool said = false;
    for (std::size_t i = 0; i < vias->size(); ++i) {
      if (!(*vias)[i].release) continue;
      if (said) Place{request, "via"}.at(i).at("release").fail("is said of another via point already");
      said = true;
      problem.release = i;
    }
  }
  if (problem.weights.tip_speed > 0 && !problem.release && problem.goal.at_rest) {
    Place{request, "objective.tip_speed"}.fail(
        "the arm moves nowhere that is named: needs a via point, or a moving goal");
  }
}

// Refuses a motion that stays where it is, unless a duration is given, because otherwise it takes no time at all.
void refuse_empty_motion(const Request& request, const Problem& problem) {
  const bool takes_time = problem.duration.fixed() || problem.duration.min > kShortestDuration;
  if (takes_time || !problem.start_at_rest || !problem.goal.at_rest || !problem.via.empty()) return;
  bool same = true;
  for (std::size_t j = 0; j < kJoints; ++j) {
    same = same && (problem.goal.free[j] || std::abs(problem.start.q[j] - problem.goal.q[j]) <= kNoMotion);
  }
  if (same) Place{request, "goal"}.fail("start and goal are the same state; nothing to plan");
}

double resolve_confidence(const Request& request, const Parameters& robot) {
  const double confidence = request.robust->confidence;
  const Place place{request, "robust"};
  if (!(confidence >= kLeastConfidence && confidence <= kMostConfidence)) {
    place.at("confidence").fail(fmt::format("{} is outside [{}, {}]", confidence, kLeastConfidence, kMostConfidence));
  }
  if (uncertainty_of(robot).none()) {
    place.fail(kNothingUncertain);
  }
  return confidence;
}

// Checks members that a program may have set as strictly as those of a document, such as for finite numbers.
void check_as_document(const Request& request) {
  (void)read_request(YamlNode::parse(format_request(request), request.source));
}

}  // namespace

Problem resolve(const Request& request, const Parameters& robot) {
  check_as_document(request);
  Problem problem;
  problem.name = std::filesystem::path(request.source).stem().string();
  problem.robot = robot;
  if (request.payload) {
    check_payload(request);
    problem.robot.payload = *request.payload;
  }
  if (request.robust) problem.robust = resolve_confidence(request, problem.robot);
  problem.proven = request.proven;
  problem.limits = resolve_limits(request, problem.robot);
  problem.duration = resolve_duration(request);
  problem.weights = resolve_weights(request, problem.robot, problem.duration);
  if (request.sample_period) {
    problem.sample_period = problem.longest_sample_period = resolve_sample_period(request, problem.duration);
  }
  problem.method = resolve_method(request);
  if (request.seed) problem.seed = *request.seed;
  problem.search = request.search.value_or(Thoroughness::kDefault);
  resolve_start(request, problem);
  const auto* tip = std::get_if<TipGoal>(&request.goal);
  tip != nullptr ? resolve_tip_goal(request, *tip, problem)
                 : resolve_joint_goal(request, std::get<JointGoal>(request.goal), problem);
  if (const auto* vias = std::get_if<std::vector<RequestedVia>>(&request.way)) resolve_vias(request, *vias, problem);
  resolve_release(request, problem);
  resolve_task(request, problem);
  check_time_left(request, problem);
  check_task(request, problem);
  refuse_empty_motion(request, problem);
  problem.request_hash = request_hash(problem);
  return problem;
}

}  // namespace fjr
