// One validated request in which everything is resolved to numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/dynamics.h"
#include "model/parameters.h"
#include "planner/problem/objective_terms.h"
#include "planner/problem/quantities.h"
#include "planner/problem/task/shapes.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

struct MotionPrice;  // planner/problem/motion_price.h

struct Goal {
  Joints<double> q{};                    // [rad]
  Joints<bool> free{};                   // joints that may end anywhere; their q is only for guesses
  Joints<double> dq{};                   // [rad/s]
  bool dq_free = false;                  // dq and the motors may be anything
  std::optional<Joints<double>> theta;   // [rad]; none: free
  std::optional<Joints<double>> dtheta;  // [rad/s]; none: free
  bool at_rest = true;                   // dq = dtheta = 0 and theta in equilibrium (given, unless a joint is free)
  bool of_tip_velocity = false;          // dq follows from goal.tip_velocity

  bool any_free() const { return free[0] || free[1]; }
};

struct Via {
  std::optional<double> time;        // [s] after the start, strictly increasing over the vias; none: any time
  Joints<double> q{};                // [rad]
  std::optional<Joints<double>> dq;  // [rad/s]
  double tolerance = 0;              // [rad] of each angle
};

inline constexpr double kShortestDuration = 0.02, kLongestDuration = 120;  // [s] bounds of what a request may ask for
inline constexpr double kLongestByDefault = 20;  // [s] longest free duration if the request gives no bound

struct Duration {
  double min = 0, max = 0;  // [s]; equal when fixed
  bool fixed() const { return min == max; }
};

// A relaxation of the request, used to tell how far it is from feasible (planner/search/explain). Each limit is relaxed
// by the slack times its direction, and the slack is minimised beside the weighted terms.
struct Slack {
  std::vector<double> direction;        // per limit, by index, then per row of the task; each in its own unit
  std::optional<std::size_t> velocity;  // the requested velocity at this via point (via.size(): at the goal) is lowered
                                        // by the slack, as a fraction
  double most = 1;                      // the largest slack
};

// How many minima are looked for: one; as many as the objective makes worthwhile; four times as many.
enum class Thoroughness { kQuick, kDefault, kThorough };

inline constexpr double kLeastConfidence = 0.5, kMostConfidence = 0.999;  // bounds of Problem::robust

// Margins that the motion keeps to each limit because the arm's parameters are uncertain.
struct Reserve {
  std::vector<double> places;                // increasing: where each piece ends, counted in segments of the motion
  std::vector<std::vector<double>> margins;  // per piece: one per limit, by index, then one per row of the task

  // Returns the largest margin of index i between two places; 0 if there is none.
  double largest(std::size_t i, double from, double to) const {
    double most = 0;
    const auto first = std::upper_bound(places.begin(), places.end(), from);
    for (auto piece = static_cast<std::size_t>(first - places.begin()); piece < margins.size(); ++piece) {
      most = std::max(most, margins[piece][i]);
      if (places[piece] >= to) break;
    }
    return most;
  }
};

// A time in which the arm is to stand still, held by friction: nothing moves faster than `speed`, and the
// friction-compensated torque is no more than what friction has at that speed. For problems of one segment with a fixed
// duration.
struct Pause {
  double begin, end;  // [s]
  double speed;       // [rad/s]

  double duration() const { return end - begin; }
  bool contains(double time) const { return time > begin && time < end; }
};

// What the search changes of the problem that was asked for, in order to solve that. None of it is part of a request,
// and a resolved request has none.
struct ProblemVariation {
  std::optional<Slack> slack;
  Reserve reserve;                           // margins for the arms of Problem::robust
  std::shared_ptr<const MotionPrice> price;  // added to the weighted terms
  std::optional<Pause> pause;                // in which an arm with time to spare waits
  std::vector<double> longest;               // [s] of each segment; empty: what the request allows
};

inline constexpr const char* kDefaultMethod = "hermite-simpson";
inline constexpr double kDefaultSamplePeriod = 0.001, kLongestSamplePeriod = kLongestSpacing;  // [s]
inline constexpr std::size_t kMostVias = 32;                                                   // or corners of a path
inline constexpr double kShortestSegment = 1e-3;                                               // [s]

struct Problem {
  Parameters robot;
  Limits limits;
  State<double> start{};
  bool start_at_rest = true;
  Goal goal;
  std::vector<Goal> other_goals;  // alternatives to `goal`, such as the other elbow for a tip position
  Duration duration;
  Weights weights;
  std::vector<Via> via;                // in this order; the motion has a segment before each and one after the last
  std::optional<std::size_t> release;  // the via point at which a thrown object is released; none: the goal
  Task task;
  std::optional<double> robust;  // fraction of the possible arms that has to keep everything; none: only the robot
  bool proven = false;           // certified only if the certificate is proven too (certificate/proof/prove.h)
  double sample_period = kDefaultSamplePeriod;  // [s] between rows
  // [s] used if there would be too many rows; larger than sample_period only if the request does not fix that.
  double longest_sample_period = kLongestSamplePeriod;
  std::uint64_t seed = 1;
  Thoroughness search = Thoroughness::kDefault;
  std::string method = kDefaultMethod;  // of collocation, a name of collocation/scheme.h
  std::string name;                     // of the request file, without extension
  std::string request_hash;             // SHA-256 over the resolved values, not over the file's bytes
  ProblemVariation variation;           // computed by the search
};

// Returns the torque |G(q)| [N m] that holds the arm at the goal, per motor; 0 if the goal moves or leaves a joint
// free.
inline Joints<double> held_at_goal(const Problem& problem) {
  if (!problem.goal.at_rest || problem.goal.any_free()) return {0, 0};
  const Joints<double> gravity = gravity_torque(problem.robot, problem.goal.q);
  return {std::abs(gravity[0]), std::abs(gravity[1])};
}

// Returns the link angles [rad] of start, via points and goal, between which the segments lie.
inline std::vector<Joints<double>> waypoints(const Problem& problem) {
  std::vector<Joints<double>> points{problem.start.q};
  for (const Via& via : problem.via) points.push_back(via.q);
  points.push_back(problem.goal.q);
  return points;
}

// Returns whether any via point has a prescribed time.
inline bool any_timed(const Problem& problem) {
  return std::any_of(problem.via.begin(), problem.via.end(), [](const Via& via) { return via.time.has_value(); });
}

}  // namespace fjr
