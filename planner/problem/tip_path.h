// The path that a task keeps the tip to: a line or an arc.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/task/task.h"

namespace fjr {

struct TipPath {
  std::string name;    // of the constraint
  std::size_t number;  // of the constraint (each_constraint())
  double tolerance;    // [m]
  Coordinates from, to;
  // Returns the tip's position [m] at a fraction of the path between two of its positions, which need not lie on the
  // path exactly.
  std::function<Coordinates(const Coordinates& from, const Coordinates& to, double fraction)> along;
};

// Returns the first constraint of the task that has a function along(constraint, from, to, fraction), and members from,
// to and tolerance.
std::optional<TipPath> tip_path(const Task& task);

// Returns points from one end to the other, so close that the lines between them are within 0.1 mm of the path.
std::vector<Coordinates> points_along(const TipPath& path);

}  // namespace fjr
