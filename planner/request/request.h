// What a user may ask for: one struct for request files, for the documents on DDS and for programs that build a
// request. Its keys, with their units and meanings, are the visit() functions below: reading and writing go by them,
// and a test holds docs/requests.md to their names. A new key is a member, its line in visit(), and what it comes to in
// resolve.cc.
//
// Members are what was said, not yet what it means: nothing here knows the robot. Each can be set by itself: where
// there is a choice of one kind of thing, it is a variant, and what contradicts another member is refused by resolve().
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
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

struct AnyVelocity {};
using VelocityOrFree = std::variant<Joints<double>, AnyVelocity>;

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

using RequestedObjective = std::variant<Preset, Weights>;

struct RequestedVia {
  std::optional<double> time;
  std::optional<Joints<double>> q, dq;
  bool release = false;
};

using RequestedTip = std::variant<TipBox, TipLine, TipArc>;

// As it is written: a key for each kind, of which one is given.
struct TipByKind {
  std::optional<TipBox> box;
  std::optional<TipLine> line;
  std::optional<TipArc> arc;
};
TipByKind by_kind(const RequestedTip& tip);

struct RequestedPath {
  std::vector<Joints<double>> points;
  double tolerance = 0;
};

struct RequestedRobustness {
  double confidence = 0;
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
  std::optional<Thoroughness> search;
  std::optional<RequestedRobustness> robust;
  bool proven = false;
};

// ---- the keys ----

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
  v(Key{"via", "", "points that are passed, in this order", "none", "at most 32"}, r.via);
  v(Key{"obstacles", "", "discs in the plane of motion that both links keep clear of", "none",
        "at most 64, walls included"},
    r.obstacles);
  v(Key{"walls", "", "straight lines that both links keep to one side of", "none",
        "the base is on that side; at most 64, obstacles included"},
    r.walls);
  v(Key{"tip", "", "where the tip may be all the way: one of `box`, `line`, `arc`", "anywhere"}, r.tip);
  v(Key{"path", "", "straight lines in the joint angles", "none", "not beside `via`"}, r.path);
  v(Key{"limits", "", "magnitudes that are not exceeded"}, r.limits);
  v(Key{"sample_period", "s", "between published rows", "0.001",
        "0.0005 to 0.005; at most 32768 rows come of it; where nothing is said, long motions have them farther apart"},
    r.sample_period);
  v(Key{"seed", "", "of the search's random starts", "1", "a whole number"}, r.seed);
  v(Key{"payload", "kg", "at the tip: a mass, or `{mass, inertia}` in kg and kg m^2", "the robot's",
        "up to 10 kg and 1 kg m^2"},
    r.payload);
  v(Key{"method", "", "collocation scheme ([what each is good for](performance.md#collocation-schemes))",
        "`hermite-simpson`", "`trapezoidal`, `hermite-simpson`, `lobatto4`, `radau3`"},
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
requires std::is_same_v<std::remove_const_t<R>, RequestedGoal>
void visit(R& r, Visit&& v) {
  v(Key{"q", "rad", "link angles; one of the two may be `free`", "needed, this or `goal.tip`",
        "within `link_position`"},
    r.q);
  v(Key{"dq", "rad/s", "link velocities, or `free`", "0: at rest", "up to 100"}, r.dq);
  v(Key{"theta", "rad", "motor angles of a moving goal", "free", "beside `dq` only, within `spring_deflection` of q"},
    r.theta);
  v(Key{"dtheta", "rad/s", "motor velocities of a moving goal", "free", "beside `dq` only, within `motor_velocity`"},
    r.dtheta);
  v(Key{"tip", "m", "position of the tip", "needed, this or `goal.q`", "within reach, 0.04 to 0.65 from the base"},
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
requires std::is_same_v<std::remove_const_t<R>, RequestedDuration>
void visit(R& r, Visit&& v) {
  v(Key{"min", "s", "at least", "0.02", "0.02 to 120"}, r.min);
  v(Key{"max", "s", "at most", "20; 120 for a `min` above 20", "0.02 to 120"}, r.max);
}

// ---- reading, writing, resolving ----

// Reads strictly what a document says (config/requests/annotated.yaml has every key). Throws InputError naming source,
// field, value and what is allowed, for what is malformed; whether it makes sense is resolve()'s to say.
Request read_request(const YamlNode& root);

// A request as a document of one line that read_request() reads back to the same bits.
std::string format_request(const Request& request);

// The task of a resolved request, as plan.json has it (resolved_request.task).
Task read_task(const YamlNode& node);

// Resolves a request to numbers: presets, defaults, moving starts by flatness, limits tightened. Throws InputError for
// what contradicts itself or the robot (outside limits, static torque too large, free duration without a time weight,
// ...). Nothing is optimised here.
Problem resolve(const Request& request, const Parameters& robot);

// Reads and resolves. folder: what a relative `robot` is relative to. default_robot: used when the request names none;
// empty: the shipped one, looked for only then.
Problem load_request(const std::filesystem::path& file, const std::filesystem::path& default_robot = {});
Problem parse_request(const std::string& yaml, const std::string& source, const std::filesystem::path& folder,
                      const std::filesystem::path& default_robot = {});

// The file of the robot that a request is for, with folder and default_robot as above.
std::filesystem::path robot_file_of(const Request& request, const std::filesystem::path& folder,
                                    const std::filesystem::path& default_robot = {});

// What counts where a request names no objective.
Preset default_preset(const Duration& duration);

// The same for a robot that is known already, from a request that names none.
Problem parse_request(const std::string& yaml, const std::string& source, const Parameters& robot);
Problem resolve_for(const Request& request, const Parameters& robot);

// SHA-256 over the resolved values, not over the file's bytes.
std::string request_hash(const Problem& problem);

}  // namespace fjr
