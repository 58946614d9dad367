// The line or the arc that a task keeps the tip to, as points.
#pragma once

#include <vector>

#include "planner/problem/task/task.h"

namespace fjr {

// Where the tip is at a share of the way between two of its positions, which need not lie on the path exactly. [m]
Pair<double> along(const TipLine& line, const Pair<double>& from, const Pair<double>& to, double share);
Pair<double> along(const TipArc& arc, const Pair<double>& from, const Pair<double>& to, double share);

// From one end to the other, close enough together for no point between to be missed by more than 0.1 mm.
std::vector<Pair<double>> points_along(const TipLine& line);
std::vector<Pair<double>> points_along(const TipArc& arc);

}  // namespace fjr
