#include "planner/search/rigid_arm.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "model/kinematics.h"
#include "model/link_dynamics.h"

namespace fjr {
namespace {

// Length [m] of the tip's path if both joints turn evenly.
double tip_way(const Problem& problem, const Joints<double>& from, const Joints<double>& to) {
  constexpr int kPieces = 32;
  double path = 0;
  Point<double> last = tip_position(problem.robot, from);
  for (int i = 1; i <= kPieces; ++i) {
    const double fraction = static_cast<double>(i) / kPieces;
    const Point<double> tip = tip_position(
        problem.robot, Joints<double>{std::lerp(from[0], to[0], fraction), std::lerp(from[1], to[1], fraction)});
    path += std::hypot(tip.x - last.x, tip.y - last.y);
    last = tip;
  }
  return path;
}

// Accelerations [rad/s^2] that the limits of torque allow each joint alone, without gravity. elbow: q2 [rad].
Joints<double> rigid_acceleration(const Problem& problem, double elbow) {
  const MassMatrix<double> mass = mass_matrix(problem.robot, elbow);
  const Joints<double> inertia{mass.m11, mass.m22};
  Joints<double> acceleration;
  for (std::size_t j = 0; j < kJoints; ++j) {
    acceleration[j] = problem.limits.torque[j] / (inertia[j] + problem.robot.motor.inertia[j]);
  }
  return acceleration;
}

// [s] The least time from point to point if no joint is faster than `speed` times its motor may be, and the tip is as
// fast as it may be.
double time_at_full_speed(const Problem& problem, const Joints<double>& from, const Joints<double>& to, double speed) {
  double time = 0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    time = std::max(time, std::abs(to[j] - from[j]) / (speed * problem.limits.motor_velocity[j]));
  }
  if (!std::isfinite(problem.limits.tip_speed)) return time;
  return std::max(time, tip_way(problem, from, to) / problem.limits.tip_speed);
}

// [rad] How far a transfer comes in this time if it first accelerates by `first` [rad/s^2] and then by as much the
// other way.
double distance_in(const JointTransfer& transfer, double time, double first) {
  const double begin = (time + (transfer.to - transfer.from) / first) / 2, end = time - begin;
  return transfer.from * begin + first * begin * begin / 2 + transfer.to * end + first * end * end / 2;
}

constexpr std::size_t kBounds = 5;

// Returns times [s] at which a transfer may begin or cease to be possible; infinite ones take the place of others.
std::array<double, kBounds> bounds_on_times(const JointTransfer& t) {
  std::array<double, kBounds> bounds;
  bounds.fill(kNoLimit);
  bounds[0] = std::abs(t.to - t.from) / t.most;
  std::size_t next = 1;
  for (const double first : {t.most, -t.most}) {
    const double square = first * t.distance + (t.from * t.from + t.to * t.to) / 2;
    if (square < 0) continue;
    for (const double peak : {std::sqrt(square), -std::sqrt(square)}) {
      bounds[next++] = (2 * peak - t.from - t.to) / first;
    }
  }
  return bounds;
}

constexpr double kLinksAndMotors = 1.5;  // springs let links be faster than motors may be, for a while

// What has to be known of a segment.
struct Way {
  Joints<double> distance, acceleration;  // [rad], [rad/s^2]
  double least;                           // [s]
  double most_excess;                     // times `acceleration`, see time_of()
};

std::vector<Way> ways(const Problem& problem) {
  const std::vector<Joints<double>> points = waypoints(problem);
  // A throw is to swing back first where the way to the release is short.
  const double most_excess = has_reward(problem.weights) ? 1 : 16;
  std::vector<Way> result;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Joints<double>&from = points[i], &to = points[i + 1];
    result.push_back({.distance = {to[0] - from[0], to[1] - from[1]},
                      .acceleration = rigid_acceleration(problem, std::midpoint(from[1], to[1])),
                      .least = std::max(kShortestSegment, time_at_full_speed(problem, from, to, kLinksAndMotors)),
                      .most_excess = most_excess});
  }
  return result;
}

// A segment's time [s], and what it counts as.
struct PricedTime {
  double time, price;
};

// Velocities of a coarse grid seldom fit each other: over a short way a joint can change its velocity only a little.
// Accelerations in excess of the joints' are therefore allowed, and the time counts as many times as they are higher.
// From rest to rest a time would be shorter by the root of that only, so that the excess is used where all else is much
// slower.
PricedTime time_of(const Way& way, const Joints<double>& from, const Joints<double>& to) {
  PricedTime best{kNoLimit, kNoLimit};
  for (double excess = 1; excess <= way.most_excess && way.least * excess < best.price; excess *= 2) {
    std::array<JointTransfer, kJoints> transfers;
    for (std::size_t j = 0; j < kJoints; ++j) {
      transfers[j] = {way.distance[j], from[j], to[j], excess * way.acceleration[j]};
    }
    const double time = shortest_common_time(transfers, way.least);
    if (time * excess < best.price) best = {time, time * excess};
  }
  return best;
}

// The velocities at one point that are compared.
struct Layer {
  std::vector<Joints<double>> velocities;
  std::vector<double> prices;        // of the way from the start, [s]
  std::vector<double> last_times;    // of the last segment of it [s]
  std::vector<std::size_t> befores;  // the velocity that it comes from, in the layer before
};

// Returns the next layer, each of whose velocities is reached at the lowest price.
Layer next_layer(const Layer& layer, std::vector<Joints<double>> velocities, const Way& way) {
  Layer next{.velocities = std::move(velocities), .prices = {}, .last_times = {}, .befores = {}};
  for (const Joints<double>& to : next.velocities) {
    double lowest = kNoLimit, last_time = 0;
    std::size_t before = 0;
    for (std::size_t k = 0; k < layer.velocities.size(); ++k) {
      if (layer.prices[k] + way.least >= lowest) continue;
      const PricedTime segment = time_of(way, layer.velocities[k], to);
      if (layer.prices[k] + segment.price >= lowest) continue;
      lowest = layer.prices[k] + segment.price;
      last_time = segment.time;
      before = k;
    }
    next.prices.push_back(lowest);
    next.last_times.push_back(last_time);
    next.befores.push_back(before);
  }
  return next;
}

Passing fastest_of(const std::vector<Layer>& layers) {
  const std::vector<double>& ends = layers.back().prices;
  auto k = static_cast<std::size_t>(std::min_element(ends.begin(), ends.end()) - ends.begin());
  Passing passing{.velocities = {}, .times = {}, .price = ends[k]};
  for (std::size_t i = layers.size(); i-- > 0;) {
    passing.velocities.push_back(layers[i].velocities[k]);
    if (i == 0) break;
    passing.times.push_back(layers[i].last_times[k]);
    k = layers[i].befores[k];
  }
  std::reverse(passing.velocities.begin(), passing.velocities.end());
  std::reverse(passing.times.begin(), passing.times.end());
  return passing;
}

// Returns velocities [rad/s] within `reach` of `centre`, so many to either side, not above `most`, and the centre
// itself.
std::vector<Joints<double>> velocities_around(const Joints<double>& centre, const Joints<double>& reach,
                                              const Joints<double>& most, int each_way) {
  std::vector<Joints<double>> velocities{centre};
  const auto at = [&](std::size_t j, int i) {
    return std::clamp(centre[j] + reach[j] * i / each_way, -most[j], most[j]);
  };
  for (int i = -each_way; i <= each_way; ++i) {
    for (int k = -each_way; k <= each_way; ++k) {
      if (i != 0 || k != 0) velocities.push_back({at(0, i), at(1, k)});
    }
  }
  return velocities;
}

// The velocities that the problem prescribes at start, via points and goal.
std::vector<std::optional<Joints<double>>> prescribed_velocities(const Problem& problem) {
  std::vector<std::optional<Joints<double>>> velocities{problem.start.dq};
  for (const Via& via : problem.via) velocities.push_back(via.dq);
  velocities.push_back(problem.goal.dq_free ? std::nullopt : std::optional(problem.goal.dq));
  return velocities;
}

}  // namespace

std::vector<double> times_between_rests(const Problem& problem) {
  constexpr double kShortest = 0.02;  // [s]
  const std::vector<Joints<double>> points = waypoints(problem);
  const Joints<double> acceleration = rigid_acceleration(problem, 0);  // stretched, where it is least
  std::vector<double> times;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    double time = std::max(kShortest, time_at_full_speed(problem, points[i], points[i + 1], 1));
    for (std::size_t j = 0; j < kJoints; ++j) {
      time = std::max(time, 2 * std::sqrt(std::abs(points[i + 1][j] - points[i][j]) / acceleration[j]));
    }
    times.push_back(time);
  }
  return times;
}

bool can_take(const JointTransfer& transfer, double time) {
  constexpr double kRounding = 1e-9;
  const double speed = std::abs(transfer.from) + std::abs(transfer.to);
  if (time * transfer.most < std::abs(transfer.to - transfer.from) - kRounding * (1 + speed)) return false;
  const double rounding = kRounding * (1 + std::abs(transfer.distance) + speed * time);  // [rad]
  return distance_in(transfer, time, transfer.most) >= transfer.distance - rounding &&
         distance_in(transfer, time, -transfer.most) <= transfer.distance + rounding;
}

double shortest_common_time(const std::array<JointTransfer, kJoints>& transfers, double least) {
  const auto all_can_take = [&](double time) {
    return std::all_of(transfers.begin(), transfers.end(),
                       [time](const JointTransfer& t) { return can_take(t, time); });
  };
  if (all_can_take(least)) return least;
  double shortest = kNoLimit;
  for (const JointTransfer& transfer : transfers) {
    for (const double time : bounds_on_times(transfer)) {
      if (time > least && time < shortest && all_can_take(time)) shortest = time;
    }
  }
  return shortest;
}

Passing fastest_passing(const Problem& problem) {
  constexpr int kRounds = 6;
  constexpr std::ptrdiff_t kMany = 8;  // open velocities; with more of them the grid is coarser, in a tenth of the time
  const std::vector<Way> segments = ways(problem);
  const std::vector<std::optional<Joints<double>>> prescribed = prescribed_velocities(problem);
  const int each_way = std::count(prescribed.begin(), prescribed.end(), std::nullopt) > kMany ? 2 : 4;
  Joints<double> most;
  for (std::size_t j = 0; j < kJoints; ++j) most[j] = kLinksAndMotors * problem.limits.motor_velocity[j];
  Passing best{.velocities = std::vector<Joints<double>>(prescribed.size()), .times = {}, .price = 0};
  Joints<double> reach = most;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Layer> layers{{.velocities = {problem.start.dq}, .prices = {0}, .last_times = {0}, .befores = {0}}};
    for (std::size_t i = 1; i < prescribed.size(); ++i) {
      std::vector<Joints<double>> velocities =
          prescribed[i] ? std::vector{*prescribed[i]} : velocities_around(best.velocities[i], reach, most, each_way);
      layers.push_back(next_layer(layers.back(), std::move(velocities), segments[i - 1]));
    }
    best = fastest_of(layers);
    for (double& r : reach) r /= 2;
  }
  if (!std::isfinite(best.price)) best.times = times_between_rests(problem);  // roundings of extreme arms
  return best;
}

}  // namespace fjr
