// Problems of the double integrator with closed forms.
#pragma once

#include "planner/collocation/transcription.h"
#include "planner/nlp/solve.h"
#include "tests/support/plants.h"

namespace fjr::double_integrator_problems {

using Plant = Transcription<DoubleIntegrator>;

inline SolveOptions exact() {
  SolveOptions o;
  o.tolerance = 1e-10;  // so that what is left is the discretisation
  return o;
}

// All states and controls zero, durations as given.
inline Iterate zeros(const Plant& nlp, double duration) {
  Iterate start{Eigen::VectorXd::Zero(nlp.variables()), {}, {}, {}};
  start.x(nlp.duration_at(0)) = duration;
  return start;
}

// |u| <= 1 from rest to rest over the distance 1.
inline Plant fastest(const Scheme& scheme, int intervals, double shortest, double longest) {
  DoubleIntegrator ocp = double_integrator({0, 0}, {1, 0}, intervals);
  ocp.time_weight = 1;
  ocp.bounds[0].u_lower = {-1};
  ocp.bounds[0].u_upper = {1};
  ocp.durations = {{shortest, longest}};
  return {ocp, scheme, equal_intervals(intervals)};
}

// int u^2 from rest to rest over `distance` in `duration`.
inline Plant gentlest(const Scheme& scheme, int intervals, double distance, double duration) {
  DoubleIntegrator ocp = double_integrator({0, 0}, {distance, 0}, intervals);
  ocp.effort = 1;
  ocp.durations = {{duration, duration}};
  return {ocp, scheme, equal_intervals(intervals)};
}

// Bryson, Denham & Dreyfus, AIAA Journal 1(11), 1963; Bryson & Ho, section 3.11: min int u^2/2, x(0) = x(1) = 0,
// v(0) = -v(1) = 1, x <= l. For l <= 1/6 the optimum is 4 / (9 l), with u linear until 3 l, zero, and linear again.
inline Plant bryson_denham(const Scheme& scheme, int intervals, double l, bool as_row) {
  DoubleIntegrator ocp = double_integrator({0, 1}, {0, -1}, intervals);
  ocp.effort = 0.5;
  (as_row ? ocp.bounds[0].row_upper[0] : ocp.bounds[0].x_upper[0]) = l;
  ocp.durations = {{1, 1}};
  return {ocp, scheme, equal_intervals(intervals)};
}

}  // namespace fjr::double_integrator_problems
