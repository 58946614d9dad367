// Points of the line or the arc that a task keeps the tip to.
#pragma once

#include <vector>

#include "planner/problem/task/task.h"

namespace fjr {

// Returns the tip's position [m] at a fraction of the path between two of its positions, which need not lie on the path
// exactly.
Coordinates along(const TipLine& line, const Coordinates& from, const Coordinates& to, double fraction);
Coordinates along(const TipArc& arc, const Coordinates& from, const Coordinates& to, double fraction);

// Returns points from one end to the other, so close that the lines between them are within 0.1 mm of the path.
std::vector<Coordinates> points_along(const TipLine& line);
std::vector<Coordinates> points_along(const TipArc& arc);

}  // namespace fjr
