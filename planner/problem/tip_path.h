// The line or the arc that a task keeps the tip to, as points.
#pragma once

#include <vector>

#include "planner/problem/task/task.h"

namespace fjr {

// Where the tip is at a fraction of the way between two of its positions, which need not lie on the path exactly. [m]
Coordinates along(const TipLine& line, const Coordinates& from, const Coordinates& to, double fraction);
Coordinates along(const TipArc& arc, const Coordinates& from, const Coordinates& to, double fraction);

// From one end to the other, close enough together for no point between to be missed by more than 0.1 mm.
std::vector<Coordinates> points_along(const TipLine& line);
std::vector<Coordinates> points_along(const TipArc& arc);

}  // namespace fjr
