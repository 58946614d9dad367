#include "planner/problem/elbow_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "planner/problem/inverse_kinematics.h"
#include "planner/problem/task/task.h"
#include "planner/problem/tip_path.h"

namespace fjr {
namespace {

constexpr double kWider = 1.2;          // times the tolerance: more than the rows allow at ends and corners
constexpr double kSameDistance = 1e-9;  // [m]

// Range of distances [m] of the tip from the base.
struct Band {
  std::string region;
  double nearest, furthest;
};

double between_zero(double lower, double upper) { return std::clamp(0.0, lower, upper); }

Band of_box(const TipBox& box) {
  const double x = std::max(std::abs(box.lower[0]), std::abs(box.upper[0])),
               y = std::max(std::abs(box.lower[1]), std::abs(box.upper[1]));
  return {kInfo<TipBox>.name,
          std::hypot(between_zero(box.lower[0], box.upper[0]), between_zero(box.lower[1], box.upper[1])),
          std::hypot(x, y)};
}

// Returns the range of the points of a path, with the tolerance round them.
Band of_path(const TipPath& path) {
  const std::vector<Coordinates> points = points_along(path);
  Band band{path.name, kNoLimit, 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double away = std::hypot(points[i][0], points[i][1]);
    band.furthest = std::max(band.furthest, away);
    band.nearest = std::min(band.nearest, away);
    if (i == 0) continue;
    const double step = std::hypot(points[i][0] - points[i - 1][0], points[i][1] - points[i - 1][1]);
    band.nearest = std::min(band.nearest, away - step / 2);  // a line may pass the base between two points
  }
  band.nearest = std::max(0.0, band.nearest - kWider * path.tolerance);
  band.furthest += kWider * path.tolerance;
  return band;
}

std::optional<Band> band_of(const Task& task) {
  if (task.box) return of_box(*task.box);
  const std::optional<TipPath> path = tip_path(task);
  return path ? std::optional(of_path(*path)) : std::nullopt;
}

const char* side(double q2) { return std::sin(q2) < 0 ? "left" : "right"; }  // same convention as inverse_kinematics()

}  // namespace

std::optional<std::string> barred_elbow(const Problem& problem) {
  const auto band = band_of(problem.task);
  if (!band || problem.goal.free[1]) return std::nullopt;
  const std::array<double, 2> within = reach(problem.robot);
  const bool stretches = band->furthest > within[1] - kSameDistance;
  const bool folds = band->nearest < within[0] + kSameDistance;
  std::vector<double> bends{problem.start.q[1]};
  for (const Via& via : problem.via) bends.push_back(via.q[1]);
  bends.push_back(problem.goal.q[1]);
  for (std::size_t i = 0; i + 1 < bends.size(); ++i) {
    const auto [low, high] = std::minmax(bends[i], bends[i + 1]);
    for (int n = static_cast<int>(std::ceil(low / std::numbers::pi)); n * std::numbers::pi <= high; ++n) {
      const double angle = n * std::numbers::pi;
      if (angle <= low || angle >= high || (n % 2 == 0 ? stretches : folds)) continue;
      return fmt::format(
          "{} keeps the tip between {:.4g} and {:.4g} m from the base, where the arm is never {} ({:.4g} m): the elbow "
          "stays on the {}, where it is {}; {} has it on the {}",
          band->region, band->nearest, band->furthest, n % 2 == 0 ? "stretched" : "folded",
          n % 2 == 0 ? within[1] : within[0], side(bends[i]),
          i == 0 ? "at the start" : fmt::format("at via[{}]", i - 1),
          i + 2 == bends.size() ? "the goal" : fmt::format("via[{}]", i), side(bends[i + 1]));
    }
  }
  return std::nullopt;
}

}  // namespace fjr
