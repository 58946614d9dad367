// Paths round the obstacles, found on a grid over the link angles: where the optimiser starts when the straight one is
// barred, and the reason when there is none.
#pragma once

#include <string>
#include <vector>

#include "planner/problem/problem.h"
#include "planner/problem/task/task.h"
#include "planner/search/guesses.h"

namespace fjr {

struct Detours {
  // Paths that keep the task at every point, shortest first, one of each homotopy class: no two of them can be pulled
  // into one another without crossing what is forbidden. Empty when there is none on the grid.
  std::vector<Path> paths;
  // The clearance of the best path there is where it is tightest [m]: when negative, by how much obstacles
  // would have to be smaller, or a box larger.
  double clearance = 0;
  Path widest;
  std::vector<std::size_t> barred_by;  // the numbers of the constraints that are broken there (each_constraint())
};

inline constexpr double kCoarseGrid = 0.06, kFineGrid = 0.02;  // [rad]: 4 cm and 1 cm at the stretched tip

// [m] A line or an arc of the tip with this tolerance or more is a region that there may be several paths through.
inline constexpr double kWideTipPath = 0.08;

// Between two postures of the motion's segment; at most `most` paths. Only obstacles, boxes and wide lines and arcs are
// looked at: others, and paths, are narrower than a grid.
Detours find_detours(const Problem& problem, std::size_t segment, const Joints<double>& from, const Joints<double>& to,
                     std::size_t most, double spacing = kCoarseGrid);

// Why there is no path at all within the limits of the joints.
struct NoPath {
  std::string sentence;  // names what bars it; empty when there is a path, or the grid is too coarse to tell
  std::vector<std::size_t> constraints;  // that bar the widest path, by their number (each_constraint())
  double missing = 0;  // [m] clearance that would open one, to within the grid; 0 where it is not known
};
NoPath no_path(const Problem& problem);

}  // namespace fjr
