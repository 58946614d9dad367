#include "planner/problem/tip_path.h"

namespace fjr {

std::optional<TipPath> tip_path(const Task& task) {
  std::optional<TipPath> found;
  std::size_t number = 0;
  each_constraint(task, [&](const std::string& name, const auto& constraint) {
    if constexpr (requires { along(constraint, Coordinates{}, Coordinates{}, 0.0); }) {
      if (found) return;
      const auto position = [constraint](const Coordinates& from, const Coordinates& to, double fraction) {
        return along(constraint, from, to, fraction);
      };
      found = TipPath{name, number, constraint.tolerance, constraint.from, constraint.to, position};
    }
    ++number;
  });
  return found;
}

std::vector<Coordinates> points_along(const TipPath& path) {
  constexpr int kPieces = 400;
  std::vector<Coordinates> points;
  for (int i = 0; i <= kPieces; ++i) {
    points.push_back(path.along(path.from, path.to, static_cast<double>(i) / kPieces));
  }
  return points;
}

}  // namespace fjr
