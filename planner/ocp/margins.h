// Limits hold at the collocation points by construction; between them they are made to hold by margins.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "planner/collocation/mesh.h"
#include "planner/problem/problem.h"
#include "planner/problem/task/task.h"
#include "planner/trajectory/motion.h"

namespace fjr {

// Fraction by which each limit is tightened everywhere: what the rollout may differ from the plan by, and more.
inline constexpr double kBaseMargin = 1e-4;

// A value for everything that is limited along the way: the limits by their index, then the task's rows; each
// in its own unit.
using PerLimit = std::vector<double>;

// What fractions are taken of: the limit itself (infinite where there is none), the scale of a task's row.
PerLimit limit_scales(const Problem& problem);

// The limits and the bounds of the task's rows as the optimiser is given them on one interval.
struct TightenedLimits {
  Limits limits;
  std::vector<std::array<double, 2>> task_rows;
};

// On each interval of the mesh: less the base margin, the interval's margin (none when empty) and the problem's
// reserve, but never tighter than what start, via points and goal ask for themselves. Leaving a state that lies on a
// limit takes time, so where one does, no margin acts near it, and the base margin of that limit is given up.
std::vector<TightenedLimits> tightened_limits(const Problem& problem, const Mesh& mesh,
                                              const std::vector<PerLimit>& margins);

// By how much each limit, less a part of the base margin, is exceeded on each interval of the motion between and at the
// collocation points, with the exact friction law (0 where it is not, and where no margin can act). A torque that
// passes the friction law's step counts with the whole step, wherever in the interval the step lies. keep: that part.
// slack: of a problem with slack, which the limits are relaxed by.
inline constexpr double kKeep = 0.8;  // leaves a fifth of the base margin to the last digits of the optimiser
std::vector<PerLimit> excesses(const Problem& problem, const Mesh& mesh, const Motion& motion, double keep = kKeep,
                               double slack = 0);

// Where the torque, with the exact friction law, is above a peak [N m] that bounds it at the collocation points, the
// excess becomes one of the limit on torque.
void add_excesses_of_peak(std::vector<PerLimit>& excesses, const Problem& problem, const Motion& motion,
                          const Joints<double>& peak);

// The limit that a motion exceeds most, as a sentence ("spring_deflection of joint 1 exceeds ..."); empty if none.
std::string worst_excess(const Problem& problem, const Mesh& mesh, const Motion& motion);

// Adds the excesses to the margins (empty: none so far), a little enlarged so that the next solution is inside. A
// margin that was not enough grows at least by the factor given, because its bound may not have been active. False when
// there was nothing to add.
bool widen(std::vector<PerLimit>& margins, const std::vector<PerLimit>& excesses, const Problem& problem,
           double growth = 2);

// Largest fraction of any limit that margins keep free somewhere.
double largest_tightening(const Problem& problem, const std::vector<PerLimit>& margins);

}  // namespace fjr
