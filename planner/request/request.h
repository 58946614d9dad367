// What a user may ask for: one struct for request files, for the documents on DDS and for programs that build a
// request. Its keys, with their units and meanings, are the visit() functions below: reading and writing go by them,
// and a test holds docs/requests.md to their names. A new key is a member, its line in visit(), and what it comes to in
// resolve.cc.
//
// Members are what was said, not yet what it means: nothing here knows the robot.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/key.h"
#include "common/strict_yaml.h"
#include "model/parameters.h"
#include "planner/problem/inverse_kinematics.h"
#include "planner/problem/problem.h"

namespace fjr {

// A state at the start: at rest unless velocities are given.
struct RequestedStart {
  std::optional<Joints<double>> q, dq, theta, dtheta;

  bool empty() const { return !q && !dq && !theta && !dtheta; }
};

// Link angles, each of which may be free (none).
using AnglesOrFree = std::array<std::optional<double>, kJoints>;

struct VelocityOrFree {
  bool free = false;
  Joints<double> value{};
};

// Either q, with what belongs to it, or tip.
struct RequestedGoal {
  std::optional<AnglesOrFree> q;
  std::optional<VelocityOrFree> dq;
  std::optional<Joints<double>> theta, dtheta;
  std::optional<Coordinates> tip;
  std::optional<Elbow> elbow;
  std::optional<Coordinates> tip_velocity;
};

// Fixed where both are the same; free where there is neither.
struct RequestedDuration {
  std::optional<double> min, max;
};

enum class Preset { kFastest, kGentle, kEfficient };

// Either a preset or weights.
struct RequestedObjective {
  std::optional<Preset> preset;
  Weights weights{};
};

struct RequestedVia {
  std::optional<double> time;
  std::optional<Joints<double>> q, dq;
  bool release = false;
};

// One of them.
struct RequestedTip {
  std::optional<TipBox> box;
  std::optional<TipLine> line;
  std::optional<TipArc> arc;
};

struct RequestedPath {
  std::vector<Joints<double>> points;
  double tolerance = 0;
};

struct Request {
  std::string source;                   // the file, or what the client calls it: for messages and for the plan's name
  std::optional<std::string> robot;     // file, relative to the request's
  std::optional<RequestedStart> start;  // none: wherever the arm rests, which only a service knows
  RequestedGoal goal;
  std::optional<RequestedDuration> duration;
  std::optional<RequestedObjective> objective;
  std::vector<RequestedVia> via;
  std::vector<Disc> obstacles;
  std::vector<Wall> walls;
  std::optional<RequestedTip> tip;
  std::optional<RequestedPath> path;
  Limits limits;  // infinite where nothing is said
  std::optional<double> sample_period;
  std::optional<std::uint64_t> seed;
  std::optional<Payload> payload;
  std::optional<std::string> method;
};

// ---- the keys ----

// visit(key, member), for a Request or a part of it, const or not.
template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, Request>
void visit(R& r, Visit&& v) {
  v(Key{"robot", "", "robot.yaml, relative to the request's file; without it the one shipped with fjr"}, r.robot);
  v(Key{"start", "", "state at the start; a service starts where the arm rests when it is left out"}, r.start);
  v(Key{"goal", "", "state at the end, or where the tip is to be", true}, r.goal);
  v(Key{"duration", "s", "a number; `free` (the default); or `{min, max}`"}, r.duration);
  v(Key{"objective", "1", "a preset (`fastest`, `gentle`, `efficient`) or weights of the terms"}, r.objective);
  v(Key{"via", "", "points that are passed, in this order"}, r.via);
  v(Key{"obstacles", "", "discs in the plane of motion that both links keep clear of"}, r.obstacles);
  v(Key{"walls", "", "straight lines that both links keep to one side of"}, r.walls);
  v(Key{"tip", "", "where the tip may be: one of `box`, `line`, `arc`"}, r.tip);
  v(Key{"path", "", "straight lines in the joint angles, in place of `via`"}, r.path);
  v(Key{"limits", "", "magnitudes; they may only tighten the robot's"}, r.limits);
  v(Key{"sample_period", "s", "between published rows, 0.0005 to 0.005"}, r.sample_period);
  v(Key{"seed", "", "of the search's random starts, a whole number"}, r.seed);
  v(Key{"payload", "kg", "at the tip: a mass, or `{mass, inertia}` in kg and kg m^2"}, r.payload);
  v(Key{"method", "", "`trapezoidal`, `hermite-simpson` (the default), `lobatto4` or `radau3`"}, r.method);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedStart>
void visit(R& r, Visit&& v) {
  v(Key{"q", "rad", "link angles"}, r.q);
  v(Key{"dq", "rad/s", "link velocities; 0 when left out"}, r.dq);
  v(Key{"theta", "rad", "motor angles; by equilibrium or flatness when left out"}, r.theta);
  v(Key{"dtheta", "rad/s", "motor velocities; likewise"}, r.dtheta);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedGoal>
void visit(R& r, Visit&& v) {
  v(Key{"q", "rad", "link angles; one of the two may be `free`"}, r.q);
  v(Key{"dq", "rad/s", "link velocities, or `free`; at rest when left out"}, r.dq);
  v(Key{"theta", "rad", "motor angles of a moving goal"}, r.theta);
  v(Key{"dtheta", "rad/s", "motor velocities of a moving goal"}, r.dtheta);
  v(Key{"tip", "m", "position of the tip, in place of q"}, r.tip);
  v(Key{"elbow", "", "`any`, `left` or `right` of the line from base to tip"}, r.elbow);
  v(Key{"tip_velocity", "m/s", "velocity of the tip at the end"}, r.tip_velocity);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedVia>
void visit(R& r, Visit&& v) {
  v(Key{"time", "s", "when, with a fixed duration; any time when left out"}, r.time);
  v(Key{"q", "rad", "link angles", true}, r.q);
  v(Key{"dq", "rad/s", "link velocities; free when left out"}, r.dq);
  v(Key{"release", "", "`true` where what is thrown is let go"}, r.release);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedTip>
void visit(R& r, Visit&& v) {
  v(Key{"box", "m", "two corners, lower left and upper right"}, r.box);
  v(Key{"line", "", "straight, within a tolerance"}, r.line);
  v(Key{"arc", "", "of a circle, within a tolerance"}, r.arc);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedPath>
void visit(R& r, Visit&& v) {
  v(Key{"points", "rad", "corners between start and goal"}, r.points);
  v(Key{"tolerance", "rad", "of each angle, 0.0001 to 1", true}, r.tolerance);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RequestedDuration>
void visit(R& r, Visit&& v) {
  v(Key{"min", "s", "at least, 0.02 to 120"}, r.min);
  v(Key{"max", "s", "at most, 0.02 to 120"}, r.max);
}

// ---- reading, writing, resolving ----

// Reads strictly what a document says (config/requests/annotated.yaml has every key). Throws InputError naming source,
// field, value and what is allowed, for what is malformed; whether it makes sense is resolve()'s to say.
Request read_request(const YamlNode& root);

// The same as a document of one line that read_request() reads back to the same bits.
std::string format_request(const Request& request);

// Resolves a request to numbers: presets, defaults, moving starts by flatness, limits tightened. Throws InputError for
// what contradicts itself or the robot (outside limits, static torque too large, free duration without a time weight,
// ...). Nothing is optimised here.
Problem resolve(const Request& request, const Parameters& robot);

// Reads and resolves. folder: what a relative `robot` is relative to. default_robot: used when the request names none;
// empty: the shipped one, looked for only then.
Problem load_request(const std::filesystem::path& file, const std::filesystem::path& default_robot = {});
Problem parse_request(const std::string& yaml, const std::string& source, const std::filesystem::path& folder,
                      const std::filesystem::path& default_robot = {});

// The same for a robot that is known already, from a request that names none.
Problem parse_request(const std::string& yaml, const std::string& source, const Parameters& robot);
Problem resolve_for(const Request& request, const Parameters& robot);

// SHA-256 over the resolved values, not over the file's bytes.
std::string request_hash(const Problem& problem);

}  // namespace fjr
