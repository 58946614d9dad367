// The keys of a request, with their units and meanings: reading and writing go by these visit() functions, and a test
// holds docs/requests.md to their names.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "common/key.h"
#include "common/strict_yaml.h"
#include "planner/collocation/scheme.h"
#include "planner/problem/task/task.h"
#include "planner/request/request.h"

namespace fjr {

// ---- requests as they are written: mutually exclusive choices have a key each ----

using VelocityOrFree = std::variant<Joints<double>, AnyVelocity>;

struct GoalByKey {
  std::optional<AnglesOrFree> q;
  std::optional<VelocityOrFree> dq;
  std::optional<Joints<double>> theta, dtheta;
  std::optional<Coordinates> tip;
  std::optional<Elbow> elbow;
  std::optional<Coordinates> tip_velocity;
};
GoalByKey by_key(const RequestedGoal& goal);

// A fault in the combination of keys, named by the first key that is superfluous or missing.
struct KeyFault {
  std::string_view key;
  std::string sentence;
};
std::optional<KeyFault> fault_of(const GoalByKey& goal);

// Returns the goal that the keys describe. Keys that do not go with others are ignored; without q and tip, both angles
// are free.
RequestedGoal goal_of(const GoalByKey& goal);

// One alternative of a variant, for the key that selects it.
template <class Kind, class Variant>
struct OneOf {
  Variant& all;  // const or not

  const Kind* get() const { return std::get_if<Kind>(&all); }
};

inline constexpr const char* kPathAndVia = "goes through its points already; give either path or via";

// As written in a request: a key for each kind, of which one is given.
struct TipByKind {
  std::optional<TipBox> box;
  std::optional<TipLine> line;
  std::optional<TipArc> arc;
};
TipByKind by_kind(const RequestedTip& tip);

// visit(key, member), for a Request or a part of it, const or not.
template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, Request>
void visit(R& r, Visit&& v) {
  v(Key{"robot", "", "a robot.yaml, relative to the request's file; a service has its own", "the one shipped with fjr"},
    r.robot);
  v(Key{"start", "", "state at the start", "needed, but a service starts where the arm rests"}, r.start);
  v(Key{"goal", "", "state at the end, or where the tip is to be", kNeeded}, r.goal);
  v(Key{"duration", "s", "a number, `free`, or `{min, max}`", "`free`", "0.02 to 120"}, r.duration);
  v(Key{"objective", "1", "a preset (`fastest`, `gentle`, `efficient`), or weights of the terms",
        "`fastest`; `gentle` where the duration is fixed"},
    r.objective);
  OneOf<std::vector<RequestedVia>, std::remove_reference_t<decltype((r.way))>> via{r.way};
  v(Key{"via", "", "points that are passed, in this order", "none", "at most 32"}, via);
  visit_obstacles(r.obstacles, [&](auto& list) { v(kRequestKey<kind_of_list<decltype(list)>>, list); });
  v(Key{"tip", "", "where the tip may be all the way: one of `box`, `line`, `arc`", "anywhere"}, r.tip);
  OneOf<RequestedPath, std::remove_reference_t<decltype((r.way))>> path{r.way};
  v(Key{"path", "", "straight lines in the joint angles", "none", "not beside `via`"}, path);
  v(Key{"limits", "", "magnitudes that are not exceeded"}, r.limits);
  v(Key{"sample_period", "s", "between published rows", "0.001",
        "0.0005 to 0.005; at most 32768 rows come of it; where nothing is said, long motions have them farther apart"},
    r.sample_period);
  v(Key{"seed", "", "of the search's random starts", "1", "a whole number"}, r.seed);
  v(Key{"payload", "kg", "at the tip: a mass, or `{mass, inertia}` in kg and kg m^2", "the robot's",
        "up to 10 kg and 1 kg m^2"},
    r.payload);
  v(Key{"method", "", "collocation scheme ([what each is good for](performance.md#collocation-schemes))",
        "`hermite-simpson`", names_of_schemes().c_str()},
    r.method);
  v(Key{"search", "", "how many minima are looked for ([what each costs](performance.md#quick-and-thorough-searches))",
        "`default`", "`quick`, `default`, `thorough`"},
    r.search);
  v(Key{"robust", "", "margins for the arms that the robot's uncertainty leaves possible ([how](#robust-motions))",
        "none: the motion is for the robot's values"},
    r.robust);
  v(Key{"proven", "", "certified only with bounds that hold with mathematical certainty ([which](theory.md#the-proof))",
        "`false`", "`true`, `false`"},
    r.proven);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedRobustness>
void visit(R& r, Visit&& v) {
  v(Key{"confidence", "1", "the fraction of those arms that keeps everything", kNeeded, "0.5 to 0.999"}, r.confidence);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedStart>
void visit(R& r, Visit&& v) {
  v(Key{"q", "rad", "link angles", "needed, but a service starts where the arm rests", "within `link_position`"}, r.q);
  v(Key{"dq", "rad/s", "link velocities", "0", "up to 100"}, r.dq);
  v(Key{"theta", "rad", "motor angles", "[what goes with q and dq](#start-and-goal)",
        "within `spring_deflection` of q"},
    r.theta);
  v(Key{"dtheta", "rad/s", "motor velocities", "likewise", "within `motor_velocity`"}, r.dtheta);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, GoalByKey>
void visit(R& r, Visit&& v) {
  v(Key{"q", "rad", "link angles; one of the two may be `free`", "needed, this or `goal.tip`",
        "within `link_position`"},
    r.q);
  v(Key{"dq", "rad/s", "link velocities, or `free`", "0: at rest", "up to 100"}, r.dq);
  v(Key{"theta", "rad", "motor angles of a moving goal", "free", "beside `dq` only, within `spring_deflection` of q"},
    r.theta);
  v(Key{"dtheta", "rad/s", "motor velocities of a moving goal", "free", "beside `dq` only, within `motor_velocity`"},
    r.dtheta);
  v(Key{"tip", "m", "position of the tip", "needed, this or `goal.q`",
        "within the arm's reach, of the shipped robot 0.04 to 0.65 from the base"},
    r.tip);
  v(Key{"elbow", "", "side of the line from base to tip that the elbow is on, beside `tip`", "`any`",
        "`any`, `left`, `right`"},
    r.elbow);
  v(Key{"tip_velocity", "m/s", "velocity of the tip at the end", "at rest", "beside `tip`"}, r.tip_velocity);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedVia>
void visit(R& r, Visit&& v) {
  v(Key{"time", "s", "when it is passed", "any time", "with a fixed duration only; 0.001 from its neighbours"}, r.time);
  v(Key{"q", "rad", "link angles", kNeeded, "within `link_position`"}, r.q);
  v(Key{"dq", "rad/s", "link velocities", "free", "up to 100"}, r.dq);
  v(Key{"release", "", "what is thrown is let go here", "at the last via point, or a moving goal",
        "`true` at one of them"},
    r.release);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, TipByKind>
void visit(R& r, Visit&& v) {
  v(Key{"box", "m", "`[[x, y], [x, y]]`: lower left and upper right corner"}, r.box);
  v(Key{"line", "", "a straight line"}, r.line);
  v(Key{"arc", "", "a part of a circle"}, r.arc);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedPath>
void visit(R& r, Visit&& v) {
  v(Key{"points", "rad", "corners between start and goal", "none", "at most 32"}, r.points);
  v(Key{"tolerance", "rad", "of each angle", kNeeded, "0.0001 to 1"}, r.tolerance);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, FreeDuration>
void visit(R& r, Visit&& v) {
  v(Key{"min", "s", "at least", "0.02", "0.02 to 120"}, r.min);
  v(Key{"max", "s", "at most", "20; 120 for a `min` from 20 on", "0.02 to 120"}, r.max);
}

// ---- writing ----

// Returns the keys that have a value, in the order of visit(): those that format_request() writes.
std::vector<std::string> said_keys(const Request& request);

// ---- reading ----

// Does the same as read_request() of a text.
Request read_request(const YamlNode& root);

// Reads the task of a resolved request from plan.json (resolved_request.task).
Task read_task(const YamlNode& node);

}  // namespace fjr
