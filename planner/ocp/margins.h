// Limits hold at the collocation points by construction. Margins, by which limits are tightened, make them hold between
// the points as well.
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

// Fraction by which each limit is tightened everywhere. It is larger than the allowed difference between rollout and
// plan.
inline constexpr double kBaseMargin = 1e-4;

// One value per limit, by its index, and then one per task constraint; each in its own unit.
using PerLimit = std::vector<double>;

// Returns the values that fractions refer to: the limit itself (infinite if there is none), or the scale of a task
// constraint.
PerLimit limit_scales(const Problem& problem);

// The limits and the bounds [lower, upper] of the task constraints that the optimiser uses on one interval.
struct TightenedLimits {
  Limits limits;
  std::vector<std::array<double, 2>> task_rows;
};

// Returns the limits on each interval of the mesh, tightened by the base margin, the margins (per interval; none if
// empty) and the problem's reserve. Start, via points and goal stay feasible: where one of them lies on a limit, that
// limit has no base margin, and no margin acts near it, because moving away from a limit takes time.
std::vector<TightenedLimits> tightened_limits(const Problem& problem, const Mesh& mesh,
                                              const std::vector<PerLimit>& margins);

// Returns by how much each limit, tightened by the fraction `base_margin` of the base margin and by the reserve, is
// exceeded on each interval of the motion, between and at the collocation points, with the exact friction law. It is 0
// where the limit holds, and where no margin can act. If the friction torque steps between two probes, the whole step
// counts. slack: value of the problem's slack, by which limits are relaxed.
inline constexpr double kCheckedBaseMargin = 0.8;  // the optimiser's inaccuracy may use up a fifth of the base margin
std::vector<PerLimit> excesses(const Problem& problem, const Mesh& mesh, const Motion& motion,
                               double base_margin = kCheckedBaseMargin, double slack = 0);

// Where the torque, with the exact friction law, exceeds the peak [N m] that bounds it at the collocation points, the
// excess is entered as an excess of the torque limit.
void add_excesses_of_peak(std::vector<PerLimit>& excesses, const Problem& problem, const Motion& motion,
                          const Joints<double>& peak);

// Returns a sentence about the limit that a motion exceeds most ("spring_deflection of joint 1 exceeds ..."); empty if
// it exceeds none.
std::string worst_excess(const Problem& problem, const Mesh& mesh, const Motion& motion);

// Adds the excesses to the margins (empty: none so far), slightly enlarged so that the next solution is inside the
// limits. A margin that did not suffice grows at least by the factor `growth`, because its bound may not have been
// active. Returns false if no margin grew.
bool widen(std::vector<PerLimit>& margins, const std::vector<PerLimit>& excesses, const Problem& problem,
           double growth = 2);

// Returns the largest fraction by which any limit is tightened on any interval.
double largest_tightening(const Problem& problem, const std::vector<PerLimit>& margins);

}  // namespace fjr
