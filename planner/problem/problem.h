// One validated request: everything resolved to numbers, nothing left to look up.
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

namespace fjr {

struct MotionPrice;  // planner/problem/motion_price.h

struct Goal {
  Joints<double> q{};                    // [rad]
  Joints<bool> free{};                   // joints that may end anywhere; their q is where a guess would put them
  Joints<double> dq{};                   // [rad/s]
  bool dq_free = false;                  // dq and the motors may be anything
  std::optional<Joints<double>> theta;   // [rad]; none: free
  std::optional<Joints<double>> dtheta;  // [rad/s]; none: free
  bool at_rest = true;                   // dq = dtheta = 0 and theta in equilibrium (given, unless a joint is free)
  bool of_tip_velocity = false;          // dq is what moves the tip as goal.tip_velocity asks for

  bool any_free() const { return free[0] || free[1]; }
};

struct Via {
  std::optional<double> time;        // [s] after the start, strictly increasing over the vias; none: any time
  Joints<double> q{};                // [rad]
  std::optional<Joints<double>> dq;  // [rad/s]
  double tolerance = 0;              // [rad] of each angle
};

inline constexpr double kShortestDuration = 0.02, kLongestDuration = 120;  // [s] that may be asked for
inline constexpr double kLongestByDefault = 20;  // [s] that a free duration may come to where nothing else is said

struct Duration {
  double min = 0, max = 0;  // [s]; equal when fixed
  bool fixed() const { return min == max; }
};

// Nothing that a request asks for, but what tells how far one is from possible (planner/search/explain): each limit
// is relaxed by the slack times its direction, and the slack is what is minimised, beside the weighted terms.
struct Slack {
  std::vector<double> direction;        // of the limits by their index, then of the task's rows; each in its own unit
  std::optional<std::size_t> velocity;  // the velocity asked for is lowered by the slack, a fraction of it, at the
                                        // via point of this index; via.size(): at the goal
  double most = 1;                      // the largest slack
};

// How many minima are looked for: one, as many as the objective is worth, four times as many.
enum class Thoroughness { kQuick, kDefault, kThorough };

inline constexpr double kLeastConfidence = 0.5, kMostConfidence = 0.999;  // that a request may ask for

// What is kept free of each limit along the motion for what is uncertain of the arm.
struct Reserve {
  std::vector<double> places;                // increasing: where each piece ends, counted in segments of the motion
  std::vector<std::vector<double>> margins;  // of each piece: the limits by their index, then the task's rows

  // The largest of index i between two places; 0 where nothing is kept.
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

inline constexpr const char* kDefaultMethod = "hermite-simpson";
inline constexpr double kDefaultSamplePeriod = 0.001, kLongestSamplePeriod = 0.005;  // [s]

struct Problem {
  Parameters robot;
  Limits limits;
  State<double> start{};
  bool start_at_rest = true;
  Goal goal;
  std::vector<Goal> other_goals;  // as good as `goal`: the other elbow of a tip position
  Duration duration;
  Weights weights;
  std::vector<Via> via;                // in this order; the motion has a segment before each and one after the last
  std::optional<std::size_t> release;  // the via point at which what is thrown is let go; none: the goal
  Task task;
  std::optional<Slack> slack;
  std::optional<double> robust;  // the fraction of the possible arms that is to keep everything; none: only the robot
  Reserve reserve;               // for them; nothing that a request says
  std::shared_ptr<const MotionPrice> price;  // beside the weighted terms; nothing that a request says
  bool proven = false;  // certified only if the certificate is proven too (certificate/proof/prove.h)
  double sample_period = kDefaultSamplePeriod;  // [s] between rows
  // [s] where that would take too many rows: more than sample_period only where the request leaves that open.
  double longest_sample_period = kLongestSamplePeriod;
  std::uint64_t seed = 1;
  Thoroughness search = Thoroughness::kDefault;
  std::string method = kDefaultMethod;  // of collocation, a name of collocation/scheme.h
  std::string name;                     // of the request file, without extension
  std::string request_hash;             // SHA-256 over the resolved values, not over the file's bytes
};

// What holding the goal takes of each motor once the arm is there, |G(q)| [N m]; 0 where the goal moves or leaves a
// joint free.
inline Joints<double> held_at_goal(const Problem& problem) {
  if (!problem.goal.at_rest || problem.goal.any_free()) return {0, 0};
  const Joints<double> gravity = gravity_torque(problem.robot, problem.goal.q);
  return {std::abs(gravity[0]), std::abs(gravity[1])};
}

// Whether a via point has a time to be passed at.
inline bool any_timed(const Problem& problem) {
  return std::any_of(problem.via.begin(), problem.via.end(), [](const Via& via) { return via.time.has_value(); });
}

}  // namespace fjr
