// A request as a user states it: one struct for request files, for documents on DDS and for programs that build
// requests. A new key needs a member, its line in visit() (request_keys.h), and its meaning in resolve.cc. Where the
// problem takes its value over as it is, a line in visit_settings() (problem_settings.h) brings it into the request's
// hash and into plan.json.
//
// Members hold what was stated, not yet resolved: nothing here depends on the robot. Each can be set by itself. Choices
// between kinds are variants, so that values of another kind cannot be left beside the chosen one. resolve() refuses
// values that make no sense, by themselves or for the robot.
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

// How the arm arrives at a goal that is given by angles.
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

// As long as the motion takes, within the bounds that are given. [s]
struct FreeDuration {
  std::optional<double> min{}, max{};
};

using RequestedDuration = std::variant<FreeDuration, double>;  // double: fixed [s]

enum class Preset { kFastest, kGentle, kEfficient };

using RequestedObjective = std::variant<Preset, Weights>;

struct RequestedVia {
  std::optional<double> time{};        // [s] only with a fixed duration
  Joints<double> q{};                  // [rad]
  std::optional<Joints<double>> dq{};  // [rad/s]; none: free
  bool release = false;                // a thrown object is released here
};

// Straight lines in the joint angles, from the start to the goal.
struct RequestedPath {
  std::vector<Joints<double>> points;  // [rad] corners between them
  double tolerance = 0;                // [rad] of each angle
};

// Intermediate points in their order, or a path that is followed.
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

// Reads a document strictly (config/requests/annotated.yaml has every key). Throws InputError with source, field, value
// and what is allowed if the document is malformed; resolve() checks whether it makes sense.
Request read_request(const std::string& yaml, const std::string& source);

// Returns a request as a document of one line, which read_request() reads back to the same bits.
std::string format_request(const Request& request);

// Resolves a request to numbers: presets, defaults, moving starts by flatness, limits tightened. Throws InputError if
// it contradicts itself or the robot (outside limits, static torque too large, free duration without a time weight,
// ...). Nothing is optimised here.
Problem resolve(const Request& request, const Parameters& robot);

// Reads and resolves a request. folder: base of a relative `robot`. default_robot: used if the request names none;
// empty: the shipped one, which is looked for only then.
Problem load_request(const std::filesystem::path& file, const std::filesystem::path& default_robot = {});
Problem parse_request(const std::string& yaml, const std::string& source, const std::filesystem::path& folder,
                      const std::filesystem::path& default_robot = {});

// Returns the robot file of a request, with folder and default_robot as above. Throws InputError if the named one is no
// file.
std::filesystem::path robot_file_of(const Request& request, const std::filesystem::path& folder,
                                    const std::filesystem::path& default_robot = {});

// As parse_request() and resolve(), but for this robot. Throw InputError if the request names one.
Problem parse_request(const std::string& yaml, const std::string& source, const Parameters& robot);
Problem resolve_for(const Request& request, const Parameters& robot);

// Returns the objective of requests that name none.
Preset default_preset(const Duration& duration);

// Returns the SHA-256 of the resolved values, not of the file's bytes.
std::string request_hash(const Problem& problem);

}  // namespace fjr
