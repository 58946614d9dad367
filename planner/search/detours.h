// Finds paths round obstacles on a grid over the link angles. The optimiser starts from them if the straight path is
// blocked. If there is no path, the reason is reported to the user.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"
#include "planner/problem/task/task.h"
#include "planner/search/guesses.h"

namespace fjr {

struct Detours {
  // Paths over cells that keep the task, shortest first, one of each homotopy class: no two of them can be pulled
  // into one another without crossing what is forbidden. Empty when there is none on the grid.
  std::vector<Path> paths;
  // Smallest clearance [m] along the widest path. If it is negative, obstacles would have to be smaller, or a box
  // larger, by this much.
  double clearance = 0;
  Path widest;
  std::vector<std::size_t> barred_by;  // constraints that the widest path violates, by number (each_constraint())
};

// [rad]: 4 cm, 1 cm and 3 mm at the stretched tip
inline constexpr double kCoarseGrid = 0.06, kFineGrid = 0.02, kFinestGrid = 0.005;

// [m] A line or an arc of the tip with at least this tolerance is a region that several paths may lead through.
inline constexpr double kWideTipPath = 0.08;

class AngleGrid;

// Finds paths on a grid over the link angles with the clearance of every cell, which is computed once for all pairs of
// postures. Only obstacles, walls, boxes and wide lines and arcs are considered, because other constraints are narrower
// than a cell.
class DetourFinder {
 public:
  // spacing: of the grid [rad]. The problem must outlive this.
  explicit DetourFinder(const Problem& problem, double spacing = kCoarseGrid);
  DetourFinder(const DetourFinder&) = delete;
  DetourFinder& operator=(const DetourFinder&) = delete;
  ~DetourFinder();

  // Finds at most `most` paths between two postures within a segment of the motion.
  Detours find(std::size_t segment, const Joints<double>& from, const Joints<double>& to, std::size_t most) const;

  // Returns whether there is certainly no path between two postures, whatever lies between the centres of the cells.
  bool is_barred(const Joints<double>& from, const Joints<double>& to) const;

 private:
  const Problem& problem_;
  std::unique_ptr<const AngleGrid> grid_;
};

// Why there is no path within the limits of the joints.
struct NoPath {
  std::string sentence;                  // names what bars it
  std::vector<std::size_t> constraints;  // that bar the widest path, by their number (each_constraint())
  double missing = 0;  // [m] clearance that would open one, to within the grid; 0 where it is not known
};
// Returns nothing when there is a path, or the grid is too coarse to tell.
std::optional<NoPath> no_path(const Problem& problem);

}  // namespace fjr
