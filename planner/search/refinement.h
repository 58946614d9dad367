// Estimates the errors of a mesh and splits its intervals.
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

// Returns the error of each interval [rad]. The compensated dynamics are integrated from the interval's own start under
// its own u by Runge-Kutta of order 4 in eight substeps, and compared with the polynomial's end; for lobatto4, of order
// 6, that is an upper bound. A velocity error counts as the position error that it causes within kErrorTime.
std::vector<double> interval_errors(const Parameters& robot, const Motion& motion);
inline constexpr double kErrorTime = 0.03;  // [s] about one radian of the fastest spring oscillation

// Returns the size of a state difference, measured likewise. [rad]
double error_size(const State<double>& difference);

// Returns the error of the scheme's quadrature of the running cost on each interval, with tau_m = u + nonlinear
// friction of the given law. It is large where a motor moves slowly within the step of the law, because the torque then
// bends between the collocation points.
std::vector<double> cost_errors(const Problem& problem, const Joints<FrictionLaw>& friction, const Scheme& scheme,
                                const Motion& motion);

// Returns into how many pieces (1, 2 or 4) each interval is to be split. Intervals whose error exceeds `tolerance` are
// split, into four if two are not enough with a method of `order`. No piece becomes shorter than `shortest` [s].
std::vector<int> pieces_wanted(const Motion& motion, const std::vector<double>& errors, double tolerance, int order,
                               double shortest);

// Returns the mesh with interval k split into pieces[k] equal pieces.
Mesh split(const Mesh& mesh, const std::vector<int>& pieces);

// Cuts of interval k as fractions of it, increasing in (0, 1).
using Cuts = std::vector<std::vector<double>>;
Mesh split(const Mesh& mesh, const Cuts& cuts);
Cuts equal_cuts(const std::vector<int>& pieces);

// Returns where motor `joint` reverses in interval k, as a fraction of the interval; the friction torque steps there.
// Returns nothing if it does not reverse.
std::optional<double> reversal_in(const Motion& motion, std::size_t k, std::size_t joint);

// Adds a cut on both sides of `fraction`, a twentieth of the interval apart but no less than `shortest` (a fraction,
// too), and removes cuts between them. A cut is left out if it would be (nearly) an end of the interval, and both are
// if the interval is hardly longer than `shortest`.
void cut_around(std::vector<double>& cuts, double fraction, double shortest);

// Returns values per interval of a mesh as values per interval of the finer one that it was split into.
template <class T>
std::vector<T> inherited(const std::vector<T>& of_parents, const std::vector<int>& pieces) {
  std::vector<T> result;
  for (std::size_t k = 0; k < of_parents.size(); ++k) {
    result.insert(result.end(), static_cast<std::size_t>(pieces[k]), of_parents[k]);
  }
  return result;
}

}  // namespace fjr
