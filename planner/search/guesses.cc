#include "planner/search/guesses.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <span>
#include <utility>

#include "common/taylor.h"
#include "model/flatness.h"
#include "planner/ocp/segments.h"
#include "planner/problem/inverse_kinematics.h"
#include "planner/problem/task/constraint.h"
#include "planner/problem/tip_path.h"
#include "planner/search/rigid_arm.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

constexpr double kShortest = 0.1;      // [s] of a guess
constexpr double kWithSprings = 1.3;   // times what a rigid arm takes: springs and friction
constexpr double kWithoutHurry = 2.0;  // likewise, for the objectives that want longer motions

double sum_of(const std::vector<double>& times) { return std::accumulate(times.begin(), times.end(), 0.0); }

// The points the motion passes, with their fractions of the duration.
struct Waypoint {
  double fraction;
  Joints<double> q;
};

// What a joint does at an end of a segment: [rad], [rad/s], [rad/s^2].
struct JointMotion {
  double q, dq, ddq;
};

// The quintic polynomial of the time from one to the other in `time` [s], as derivatives by the time at its fraction c.
void set_quintic(const JointMotion& from, const JointMotion& to, double time, double c, std::size_t j, LinkMotion& m) {
  const double d = to.q - from.q, v0 = from.dq * time, v1 = to.dq * time;
  const double a0 = from.ddq * time * time, a1 = to.ddq * time * time;
  const double k3 = 10 * d - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1, k4 = -15 * d + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
               k5 = 6 * d - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1;
  m.q[j] = from.q + c * (v0 + c * (a0 / 2 + c * (k3 + c * (k4 + c * k5))));
  m.dq[j] = (v0 + c * (a0 + c * (3 * k3 + c * (4 * k4 + c * 5 * k5)))) / time;
  m.ddq[j] = (a0 + c * (6 * k3 + c * (12 * k4 + c * 20 * k5))) / (time * time);
  m.dddq[j] = (6 * k3 + c * (24 * k4 + c * 60 * k5)) / std::pow(time, 3);
  m.ddddq[j] = (24 * k4 + c * 120 * k5) / std::pow(time, 4);
}

// Lets a passing last so long [s]. Velocities that the problem leaves open change with the times beside them.
Passing lasting(const Problem& problem, const Passing& fastest, double duration) {
  Passing slower = fastest;
  slower.times = apportioned(problem, duration, fastest.times);
  const std::size_t last = fastest.times.size();
  for (std::size_t i = 1; i <= last; ++i) {
    const bool open = i == last ? problem.goal.dq_free : !problem.via[i - 1].dq;
    const auto beside = [&](const Passing& passing) {
      return passing.times[i - 1] + (i < last ? passing.times[i] : 0);
    };
    for (double& v : slower.velocities[i]) v *= open ? beside(fastest) / beside(slower) : 1;
  }
  return slower;
}

// Returns the accelerations [rad/s^2] of joint j at start, via points and goal with which its polynomials jerk least:
// that of the start is given, that of a goal at rest is zero, and elsewhere the jerk is continuous, or zero at the end.
// The springs at the start accelerate a link for a moment only. Where the first segment lasts longer than
// `fastest_first` [s], a polynomial with all of that acceleration would swing far out.
Eigen::VectorXd passing_accelerations(const Problem& problem, const Passing& passing, double fastest_first,
                                      std::size_t j) {
  const std::vector<Joints<double>> points = waypoints(problem);
  const auto last = static_cast<Eigen::Index>(passing.times.size());
  Eigen::MatrixXd of_jerk = Eigen::MatrixXd::Zero(last + 1, last + 1);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(last + 1);
  for (Eigen::Index i = 0; i < last; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double time = passing.times[k], distance = points[k + 1][j] - points[k][j];
    const double v0 = passing.velocities[k][j] * time, v1 = passing.velocities[k + 1][j] * time;
    of_jerk(i, i) += 9 / time;
    of_jerk(i, i + 1) = of_jerk(i + 1, i) = -3 / time;
    of_jerk(i + 1, i + 1) += 9 / time;
    right(i) += (60 * distance - 36 * v0 - 24 * v1) / std::pow(time, 3);
    right(i + 1) -= (60 * distance - 24 * v0 - 36 * v1) / std::pow(time, 3);
  }
  const auto prescribe = [&](Eigen::Index i, double acceleration) {
    of_jerk.row(i).setZero();
    of_jerk(i, i) = 1;
    right(i) = acceleration;
  };
  const double slower = std::min(1.0, fastest_first / passing.times.front());
  if (problem.start_at_rest) {
    prescribe(0, 0);
  } else {
    prescribe(0, slower * slower * link_acceleration(problem.robot, problem.start)[j]);
  }
  if (problem.goal.at_rest) prescribe(last, 0);
  return of_jerk.partialPivLu().solve(right);
}

std::vector<double> durations_of(const Problem& problem, double duration) {
  return apportioned(problem, duration, times_between_rests(problem));
}

std::vector<Waypoint> timed_waypoints(const Problem& problem, const std::vector<double>& durations) {
  const auto points = waypoints(problem);
  const double whole = std::accumulate(durations.begin(), durations.end(), 0.0);
  std::vector<Waypoint> result{{0, points.front()}};
  double time = 0;
  for (std::size_t i = 0; i < durations.size(); ++i) {
    time += durations[i];
    result.push_back({i + 1 == durations.size() ? 1 : time / whole, points[i + 1]});
  }
  return result;
}

// Where a motion is at a fraction of its duration.
struct SegmentPlace {
  std::size_t segment;
  double fraction;  // of the duration, that the segment takes
  double inside;    // fraction of the segment
};

SegmentPlace place_at(std::span<const Waypoint> points, double s) {
  std::size_t segment = 0;
  while (segment + 2 < points.size() && s >= points[segment + 1].fraction) ++segment;
  const double fraction = points[segment + 1].fraction - points[segment].fraction;
  return {segment, fraction, (s - points[segment].fraction) / fraction};
}

Joints<double> between(const Joints<double>& a, const Joints<double>& b, double fraction) {
  return {a[0] + fraction * (b[0] - a[0]), a[1] + fraction * (b[1] - a[1])};
}

// Returns `count` points at equal distances along a path, its ends included.
Path resampled(const Path& path, std::size_t count) {
  std::vector<double> length{0};
  for (std::size_t k = 1; k < path.size(); ++k) {
    length.push_back(length.back() + task::distance(path[k], path[k - 1]));
  }
  Path even;
  std::size_t k = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = length.back() * static_cast<double>(i) / static_cast<double>(count - 1);
    while (k + 2 < path.size() && length[k + 1] < at) ++k;
    const double piece = length[k + 1] - length[k];
    even.push_back(between(path[k], path[k + 1], piece > 0 ? std::clamp((at - length[k]) / piece, 0.0, 1.0) : 0));
  }
  return even;
}

Path averaged(const Path& path) {
  Path result = path;
  for (std::size_t k = 1; k + 1 < path.size(); ++k) {
    for (std::size_t j = 0; j < kJoints; ++j) result[k][j] = (path[k - 1][j] + path[k][j] + path[k + 1][j]) / 3;
  }
  return result;
}

// Returns a smooth random detour of about the given size [rad] over s = 0 ... 1, zero at both ends.
std::function<Joints<double>(double)> detour_of(double size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  // The engine's bits are the same everywhere; std's distributions are not.
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53 * 2 - 1; };
  std::array<Joints<double>, 3> amplitude;  // of sin(pi s), sin(2 pi s), sin(3 pi s)
  for (std::size_t k = 0; k < amplitude.size(); ++k) {
    for (double& a : amplitude[k]) a = size * uniform() / static_cast<double>(k + 1);
  }
  return [amplitude](double s) {
    Joints<double> away{0, 0};
    for (std::size_t k = 0; k < amplitude.size(); ++k) {
      const double shape = std::sin(static_cast<double>(k + 1) * std::numbers::pi * s);
      for (std::size_t j = 0; j < kJoints; ++j) away[j] += amplitude[k][j] * shape;
    }
    return away;
  };
}

// Flash & Hogan, Journal of Neuroscience 5(7), 1985: q = d (10 c^3 - 15 c^4 + 6 c^5) from rest to rest, and its
// derivatives by c.
void add_minimum_jerk(const Joints<double>& d, double c, LinkMotion& to) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    to.q[j] += d[j] * c * c * c * (10 + c * (-15 + 6 * c));
    to.dq[j] += d[j] * c * c * (30 + c * (-60 + 30 * c));
    to.ddq[j] += d[j] * c * (60 + c * (-180 + 120 * c));
    to.dddq[j] += d[j] * (60 + c * (-360 + 360 * c));
    to.ddddq[j] += d[j] * (-360 + 720 * c);
  }
}

// A displacement to d at c = 1/2 and back with continuous accelerations, 64 d c^3 (1 - c)^3, and its derivatives by c.
LinkMotion there_and_back(const Joints<double>& d, double c) {
  LinkMotion m;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double scaled = 64 * d[j];
    m.q[j] = scaled * c * c * c * (1 + c * (-3 + c * (3 - c)));
    m.dq[j] = scaled * c * c * (3 + c * (-12 + c * (15 - 6 * c)));
    m.ddq[j] = scaled * c * (6 + c * (-36 + c * (60 - 30 * c)));
    m.dddq[j] = scaled * (6 + c * (-72 + c * (180 - 120 * c)));
    m.ddddq[j] = scaled * (-72 + c * (360 - 360 * c));
  }
  return m;
}

// How far a path is from the straight line between its ends: amplitudes [rad] of sin(k pi s), k = 1, 2, ..., where s is
// the fraction of the path.
using SineSeries = std::array<Joints<double>, 8>;

SineSeries sine_series_of(const Path& path) {
  constexpr std::size_t kPoints = 64;
  const Path even = resampled(path, kPoints);
  SineSeries series{};
  for (std::size_t i = 1; i + 1 < kPoints; ++i) {
    const double s = static_cast<double>(i) / (kPoints - 1);
    const Joints<double> straight = between(even.front(), even.back(), s);
    for (std::size_t k = 0; k < series.size(); ++k) {
      const double shape = std::sin(static_cast<double>(k + 1) * std::numbers::pi * s);
      for (std::size_t j = 0; j < kJoints; ++j)
        series[k][j] += 2.0 / (kPoints - 1) * (even[i][j] - straight[j]) * shape;
    }
  }
  return series;
}

// The distance from the straight line at the fraction c of the time, at the pace of minimum jerk, and its derivatives
// by c.
LinkMotion along_series(const SineSeries& series, double c) {
  using Expansion = Taylor<4>;
  const auto time = Expansion::from_derivatives({c, 1, 0, 0, 0});
  const Expansion pace = time * time * time * (10 + time * (-15 + 6 * time));
  LinkMotion m;
  for (std::size_t j = 0; j < kJoints; ++j) {
    Expansion away;
    for (std::size_t k = 0; k < series.size(); ++k) {
      away += series[k][j] * sin(static_cast<double>(k + 1) * std::numbers::pi * pace);
    }
    m.q[j] = away.derivative(0);
    m.dq[j] = away.derivative(1);
    m.ddq[j] = away.derivative(2);
    m.dddq[j] = away.derivative(3);
    m.ddddq[j] = away.derivative(4);
  }
  return m;
}

// Returns a guess of minimum-jerk segments plus detour(segment, c), whose derivatives are with respect to the fraction
// c of the segment. Springs, motors and torques follow from flatness.
template <class Detour>
Guess along_flat_motion(const std::string& name, const Problem& problem, double duration, const Detour& detour) {
  const std::vector<double> durations = durations_of(problem, duration);
  const auto points = timed_waypoints(problem, durations);
  const auto flat = [points, duration, detour, robot = problem.robot](double s) {
    const auto [segment, fraction, c] = place_at(points, s);
    const double time = fraction * duration;
    LinkMotion m = detour(segment, c);
    const Joints<double>&from = points[segment].q, &to = points[segment + 1].q;
    add_minimum_jerk({to[0] - from[0], to[1] - from[1]}, c, m);
    for (std::size_t j = 0; j < kJoints; ++j) {
      m.q[j] += from[j];
      m.dq[j] /= time;
      m.ddq[j] /= time * time;
      m.dddq[j] /= time * time * time;
      m.ddddq[j] /= time * time * time * time;
    }
    return from_link_motion(robot, m);
  };
  return {name, durations, [flat](double s) { return flat(s).state; },
          [flat](double s) { return flat(s).compensated_torque; }};
}

}  // namespace

Guess straight_guess(const Problem& problem, double duration) {
  const std::vector<double> durations = durations_of(problem, duration);
  const auto points = timed_waypoints(problem, durations);
  const auto state = [points, robot = problem.robot](double s) {
    const auto [segment, fraction, inside] = place_at(points, s);
    Joints<double> q;
    for (std::size_t j = 0; j < kJoints; ++j)
      q[j] = points[segment].q[j] + inside * (points[segment + 1].q[j] - points[segment].q[j]);
    return rest_at(robot, q);
  };
  return {"straight", durations, state, [](double) { return Joints<double>{0, 0}; }};
}

Guess minimum_jerk_guess(const Problem& problem, double duration) {
  return along_flat_motion("minimum jerk", problem, duration, [](std::size_t, double) { return LinkMotion{}; });
}

Guess passing_guess(const Problem& problem) {
  const Passing fastest = fastest_passing(problem);
  const double duration = std::clamp(sum_of(fastest.times), problem.duration.min, problem.duration.max);
  const Passing passing = lasting(problem, fastest, duration);
  const auto points = timed_waypoints(problem, passing.times);
  std::array<Eigen::VectorXd, kJoints> accelerations;
  for (std::size_t j = 0; j < kJoints; ++j)
    accelerations[j] = passing_accelerations(problem, passing, fastest.times.front(), j);
  const auto flat = [points, passing, accelerations, robot = problem.robot](double s) {
    const auto [segment, fraction, inside] = place_at(points, s);
    const auto at = [&](std::size_t i, std::size_t j) {
      return JointMotion{points[i].q[j], passing.velocities[i][j], accelerations[j](static_cast<Eigen::Index>(i))};
    };
    LinkMotion m;
    for (std::size_t j = 0; j < kJoints; ++j) {
      set_quintic(at(segment, j), at(segment + 1, j), passing.times[segment], inside, j, m);
    }
    return from_link_motion(robot, m);
  };
  return {"passing", passing.times, [flat](double s) { return flat(s).state; },
          [flat](double s) { return flat(s).compensated_torque; }};
}

Guess path_guess(const Problem& problem, double duration, const std::vector<Path>& paths) {
  constexpr int kRounds = 3;  // of averaging neighbours: a grid's staircase becomes a slope
  constexpr std::size_t kPoints = 64;
  const std::vector<double> durations = durations_of(problem, duration);
  const auto points = timed_waypoints(problem, durations);
  std::vector<Path> rounded;
  for (const Path& path : paths) {
    Path even = resampled(path, kPoints);
    for (int round = 0; round < kRounds; ++round) even = averaged(even);
    rounded.push_back(std::move(even));
  }
  const auto state = [points, rounded, robot = problem.robot](double s) {
    const auto [segment, fraction, inside] = place_at(points, s);
    const double at = std::clamp(inside, 0.0, 1.0) * (kPoints - 1);
    const std::size_t k = std::min(static_cast<std::size_t>(at), kPoints - 2);
    return rest_at(robot, between(rounded[segment][k], rounded[segment][k + 1], at - static_cast<double>(k)));
  };
  return {"round obstacles", durations, state, [](double) { return Joints<double>{0, 0}; }};
}

Guess smooth_path_guess(const Problem& problem, double duration, const std::vector<Path>& paths) {
  std::vector<SineSeries> series;
  for (const Path& path : paths) series.push_back(sine_series_of(path));
  return along_flat_motion("smoothly round obstacles", problem, duration,
                           [series](std::size_t segment, double c) { return along_series(series[segment], c); });
}

std::vector<Path> paths_along_tip_path(const Problem& problem) {
  constexpr int kPieces = 24;
  const auto points = waypoints(problem);
  const TipPath tip_path_of_task = tip_path(problem.task).value();
  std::vector<Path> paths;
  for (std::size_t segment = 0; segment + 1 < points.size(); ++segment) {
    const Point<double> begin = tip_position(problem.robot, points[segment]),
                        end = tip_position(problem.robot, points[segment + 1]);
    const Joints<double> from{begin.x, begin.y}, to{end.x, end.y};
    Path path{points[segment]};
    for (int i = 1; i < kPieces; ++i) {
      const double s = static_cast<double>(i) / kPieces;
      const Joints<double> tip = tip_path_of_task.along(from, to, s);
      const auto postures = inverse_kinematics(problem.robot, tip, Elbow::kAny, problem.limits, path.back());
      if (!postures.empty()) path.push_back(postures.front());
    }
    path.push_back(points[segment + 1]);
    paths.push_back(std::move(path));
  }
  return paths;
}

Guess winding_up_guess(Guess guess, const Joints<double>& back) {
  constexpr double kWindingUp = 0.5;  // fraction of the time
  guess.name = "winding up, " + guess.name;
  guess.state = [state = guess.state, back](double s) {
    State<double> x = state(s);
    const double swing = s < kWindingUp ? std::sin(std::numbers::pi * s / kWindingUp) : 0;
    for (std::size_t j = 0; j < kJoints; ++j) {
      x.q[j] -= swing * swing * back[j];
      x.theta[j] -= swing * swing * back[j];
    }
    return x;
  };
  return guess;
}

Guess folding_guess(const Problem& problem, double duration, double swing) {
  constexpr double kBackUntil = 0.4;             // fraction of the swing
  constexpr Joints<double> kBack{-0.5, -0.45};   // fractions of link 1's distance and of link 2's range
  constexpr Joints<double> kFolded{0.85, 0.98};  // likewise
  const Joints<double> from = problem.start.q, to = problem.goal.q;
  const double way = to[0] - from[0];
  const double range = std::copysign(problem.limits.link_position[1], way),
               middle = problem.robot.limits.link_middle[1];
  const auto at = [&](const Joints<double>& fractions) {
    return Joints<double>{from[0] + fractions[0] * way, middle + fractions[1] * range};
  };
  const std::array<Waypoint, 4> points{
      {{0, from}, {kBackUntil * swing / duration, at(kBack)}, {swing / duration, at(kFolded)}, {1, to}}};
  const auto state = [points, robot = problem.robot](double s) {
    const auto [segment, fraction, inside] = place_at(points, s);
    return rest_at(robot, between(points[segment].q, points[segment + 1].q, inside * inside * (3 - 2 * inside)));
  };
  return {"folding", {duration}, state, [](double) { return Joints<double>{0, 0}; }};
}

Guess staggered_guess(const Problem& problem, double duration, std::size_t first_joint) {
  constexpr double kMoves = 0.6;  // fraction of a segment's time that each joint moves
  const std::vector<double> durations = durations_of(problem, duration);
  const auto points = timed_waypoints(problem, durations);
  const auto state = [points, first_joint, robot = problem.robot](double s) {
    const auto [segment, fraction, inside] = place_at(points, s);
    Joints<double> q;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double from = j == first_joint ? 0 : 1 - kMoves, c = std::clamp((inside - from) / kMoves, 0.0, 1.0);
      q[j] = std::lerp(points[segment].q[j], points[segment + 1].q[j], c * c * (3 - 2 * c));
    }
    return rest_at(robot, q);
  };
  return {"staggered", durations, state, [](double) { return Joints<double>{0, 0}; }};
}

std::optional<Joints<double>> hanging_posture(const Problem& problem) {
  const Joints<double> pull = gravity_coefficients(problem.robot);
  if (pull[0] == 0 && pull[1] == 0) return std::nullopt;
  const Joints<double> down{problem.robot.mounting.down, 0};
  Joints<double> hanging;
  for (std::size_t j = 0; j < kJoints; ++j) {
    hanging[j] = std::clamp(down[j], problem.limits.lowest(j), problem.limits.highest(j));
  }
  return hanging;
}

std::optional<Guess> hanging_guess(const Problem& problem, double duration) {
  constexpr double kDetour = 1.2;  // times the straight way
  const std::optional<Joints<double>> hanging = hanging_posture(problem);
  if (!hanging) return std::nullopt;
  const auto durations = durations_of(problem, duration);
  const auto longest =
      static_cast<std::size_t>(std::max_element(durations.begin(), durations.end()) - durations.begin());
  const auto points = waypoints(problem);
  const Joints<double>&from = points[longest], &to = points[longest + 1];
  const double by_way_of_it = task::distance(from, *hanging) + task::distance(*hanging, to);
  if (by_way_of_it < kDetour * task::distance(from, to)) return std::nullopt;
  const Joints<double> middle = between(from, to, 0.5), detour{(*hanging)[0] - middle[0], (*hanging)[1] - middle[1]};
  return along_flat_motion("hanging", problem, duration, [longest, detour](std::size_t segment, double c) {
    return segment == longest ? there_and_back(detour, c) : LinkMotion{};
  });
}

Guess displaced_guess(const Problem& problem, double duration, double size, std::uint64_t seed) {
  Guess guess = straight_guess(problem, duration);
  guess.name = "displaced";
  guess.state = [straight = guess.state, detour = detour_of(size, seed), robot = problem.robot](double s) {
    const Joints<double> q = straight(s).q, away = detour(s);
    return rest_at(robot, {q[0] + away[0], q[1] + away[1]});
  };
  return guess;
}

Guess displaced_guess(Guess guess, double size, std::uint64_t seed) {
  guess.name = "displaced, " + guess.name;
  guess.state = [state = guess.state, detour = detour_of(size, seed)](double s) {
    State<double> x = state(s);
    const Joints<double> away = detour(s);
    for (std::size_t j = 0; j < kJoints; ++j) {
      x.q[j] += away[j];
      x.theta[j] += away[j];
    }
    return x;
  };
  return guess;
}

Guess waiting_guess(Guess guess, double first, double last) {
  const auto moved = [first, last](double s) { return std::clamp((s - first) / (1 - first - last), 0.0, 1.0); };
  Guess waiting = guess;
  waiting.name = "waiting, " + guess.name;
  waiting.state = [state = guess.state, moved](double s) { return state(moved(s)); };
  waiting.torque = [torque = guess.torque, moved](double s) { return torque(moved(s)); };
  return waiting;
}

Guess paused_guess(Guess guess, double begin, double pause) {
  const double moving = guess.duration(), whole = moving + pause;
  const auto moved = [=](double s) {
    const double time = s * whole;
    return std::clamp(time < begin ? time : std::max(begin, time - pause), 0.0, moving) / moving;
  };
  const auto pauses = [=](double s) { return s * whole > begin && s * whole < begin + pause; };
  Guess paused = guess;
  paused.name = guess.name + ", with a pause";
  paused.durations = {whole};
  paused.state = [state = guess.state, moved, pauses](double s) {
    State<double> x = state(moved(s));
    if (pauses(s)) x.dq = x.dtheta = {0, 0};
    return x;
  };
  paused.torque = [torque = guess.torque, moved](double s) { return torque(moved(s)); };
  return paused;
}

Guess guess_from(Motion motion, const std::vector<double>& durations, double duration) {
  const double length = motion.duration();
  std::vector<double> stretched = durations;
  for (double& d : stretched) d *= duration / length;
  const auto state = [motion, length](double s) { return motion.state_at(s * length); };
  const auto torque = [motion = std::move(motion), length](double s) { return motion.torque_at(s * length); };
  return {"previous", stretched, state, torque};
}

Guess guess_of(Motion motion, const std::vector<double>& durations) {
  const double duration = motion.duration();
  return guess_from(std::move(motion), durations, duration);
}

Guess guess_of(const Collocated& solution) { return guess_of(solution.motion, solution.durations); }

Guess first_segments_of(const Guess& guess, std::size_t count) {
  const std::vector<double> durations(guess.durations.begin(),
                                      guess.durations.begin() + static_cast<std::ptrdiff_t>(count));
  const double part = std::accumulate(durations.begin(), durations.end(), 0.0) / guess.duration();
  return {guess.name, durations, [state = guess.state, part](double s) { return state(part * s); },
          [torque = guess.torque, part](double s) { return torque(part * s); }};
}

double usual_duration(const Problem& problem) {
  const bool hurried = starts_worth_trying(problem.weights) == 1;
  return std::max(kShortest, sum_of(times_between_rests(problem))) * (hurried ? kWithSprings : kWithoutHurry);
}

double duration_guess(const Problem& problem) {
  return std::clamp(usual_duration(problem), problem.duration.min, problem.duration.max);
}

}  // namespace fjr
