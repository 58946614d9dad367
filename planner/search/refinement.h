// Where a mesh is too coarse, and the finer one.
#pragma once

#include <optional>
#include <vector>

#include "model/friction.h"
#include "model/parameters.h"
#include "planner/collocation/mesh.h"
#include "planner/collocation/scheme.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/motion.h"

namespace fjr {

// Error of each interval [rad]: the compensated dynamics are integrated from the interval's own start under its own u
// by Runge-Kutta of order 4 in eight substeps, and compared with the polynomial's end: for lobatto4, of order 6, that
// is an upper bound. A velocity difference counts by what it makes of the position in kErrorTime.
std::vector<double> interval_errors(const Parameters& robot, const Motion& motion);
inline constexpr double kErrorTime = 0.03;  // [s] about one radian of the fastest spring oscillation

// Size of a state difference as above. [rad]
double error_size(const State<double>& difference);

// Error of the scheme's quadrature of the objective's running cost on each interval, tau_m = u + nonlinear friction of
// the law given: where a motor creeps through the friction law, the torque bends between the collocation points.
std::vector<double> cost_errors(const Problem& problem, const Joints<FrictionLaw>& friction, const Scheme& scheme,
                                const Motion& motion);

// Into how many pieces (1, 2 or 4) each interval is to be split: those whose error exceeds `tolerance`, in four where
// two would not do for a method of `order`; no piece becomes shorter than `shortest` [s].
std::vector<int> pieces_wanted(const Motion& motion, const std::vector<double>& errors, double tolerance, int order,
                               double shortest);

// Interval k in pieces[k] equal pieces.
Mesh split(const Mesh& mesh, const std::vector<int>& pieces);

// Interval k cut at cuts[k], in fractions of it, increasing in (0, 1).
using Cuts = std::vector<std::vector<double>>;
Mesh split(const Mesh& mesh, const Cuts& cuts);
Cuts equal_cuts(const std::vector<int>& pieces);

// Where in interval k motor `joint` reverses, as a fraction of it: the friction torque steps there. None: it does not.
std::optional<double> reversal_in(const Motion& motion, std::size_t k, std::size_t joint);

// Adds a cut on both sides of `fraction`, a twentieth of the interval apart but no less than `shortest` (a fraction,
// too), in place of any between; none where that would be (nearly) an end of the interval, or the interval is hardly
// longer.
void cut_around(std::vector<double>& cuts, double fraction, double shortest);

// What was known per interval of the mesh that was split, per interval of the finer one.
template <class T>
std::vector<T> inherited(const std::vector<T>& of_parents, const std::vector<int>& pieces) {
  std::vector<T> result;
  for (std::size_t k = 0; k < of_parents.size(); ++k) {
    result.insert(result.end(), static_cast<std::size_t>(pieces[k]), of_parents[k]);
  }
  return result;
}

}  // namespace fjr
