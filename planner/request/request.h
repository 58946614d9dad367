// What a user may ask for: one struct for request files, for the documents on DDS and for programs that build a
// request. A new key is a member, its line in visit() (request_keys.h), and what it comes to in resolve.cc.
//
// Members are what was said, not yet what it means: nothing here knows the robot. Each can be set by itself: where
// there is a choice of one kind of thing, it is a variant, so that nothing of another kind can be left beside it. What
// makes no sense for its value, or for this robot, is refused by resolve().
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/kinematics.h"
#include "model/parameters.h"
#include "planner/problem/problem.h"

namespace fjr {

// A state at the start: at rest unless velocities are given.
struct RequestedStart {
  Joints<double> q{};                               // [rad]
  std::optional<Joints<double>> dq{};               // [rad/s]
  std::optional<Joints<double>> theta{}, dtheta{};  // [rad], [rad/s] of the motors; none: what goes with q and dq
};

// Link angles, each of which may be free (none). [rad]
using AnglesOrFree = std::array<std::optional<double>, kJoints>;

// How the arm comes to a goal that its angles say.
struct AtRest {};
struct AnyVelocity {};  // of links and motors
struct Moving {
  Joints<double> dq{};                              // [rad/s]
  std::optional<Joints<double>> theta{}, dtheta{};  // [rad], [rad/s] of the motors; none: free
};
using Arrival = std::variant<AtRest, AnyVelocity, Moving>;

struct JointGoal {
  AnglesOrFree q{};
  Arrival arrival{};
};

struct TipGoal {
  Coordinates tip{};  // [m]
  Elbow elbow = Elbow::kAny;
  std::optional<Coordinates> velocity{};  // [m/s] of the tip; none: at rest
};

using RequestedGoal = std::variant<JointGoal, TipGoal>;

// As the motion takes, between bounds where they are given. [s]
struct FreeDuration {
  std::optional<double> min{}, max{};
};

using RequestedDuration = std::variant<FreeDuration, double>;  // the latter fixed [s]

enum class Preset { kFastest, kGentle, kEfficient };

using RequestedObjective = std::variant<Preset, Weights>;

struct RequestedVia {
  std::optional<double> time{};        // [s] only with a fixed duration
  Joints<double> q{};                  // [rad]
  std::optional<Joints<double>> dq{};  // [rad/s]; none: free
  bool release = false;                // what is thrown is let go here
};

// Straight lines in the joint angles, from the start to the goal.
struct RequestedPath {
  std::vector<Joints<double>> points;  // [rad] corners between them
  double tolerance = 0;                // [rad] of each angle
};

// What is on the way: points that are passed, in this order, or a path that is kept to.
using RequestedWay = std::variant<std::vector<RequestedVia>, RequestedPath>;

using RequestedTip = std::variant<TipBox, TipLine, TipArc>;

struct RequestedRobustness {
  double confidence = 0;
};

struct Request {
  std::string source;                   // the file, or what the client calls it: for messages and for the plan's name
  std::optional<std::string> robot;     // file, relative to the request's
  std::optional<RequestedStart> start;  // none: wherever the arm rests, which only a service knows
  RequestedGoal goal;
  RequestedDuration duration;
  std::optional<RequestedObjective> objective;
  RequestedWay way;
  Obstacles obstacles;
  std::optional<RequestedTip> tip;
  Limits limits;  // infinite where nothing is said
  std::optional<double> sample_period;
  std::optional<std::uint64_t> seed;
  std::optional<Payload> payload;
  std::optional<std::string> method;
  std::optional<Thoroughness> search;
  std::optional<RequestedRobustness> robust;
  bool proven = false;
};

// ---- reading, writing, resolving ----

// Reads strictly what a document says (config/requests/annotated.yaml has every key). Throws InputError naming source,
// field, value and what is allowed, for what is malformed; whether it makes sense is resolve()'s to say.
Request read_request(const std::string& yaml, const std::string& source);

// A request as a document of one line that read_request() reads back to the same bits.
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

// The file of the robot that a request is for, with folder and default_robot as above. Throws InputError where the one
// that it names is no file.
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
