// Solves one problem on a given mesh, with a given friction law, from a given start.
#pragma once

#include <vector>

#include "planner/collocation/mesh.h"
#include "planner/collocation/scheme.h"
#include "planner/nlp/solve.h"
#include "planner/ocp/guess.h"
#include "planner/ocp/margins.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/motion.h"

namespace fjr {

// The difference between the problem that is solved and the requested one; smaller values are closer to it.
struct Smoothing {
  double friction_width = 0;     // [rad/s] of the smoothed law; 0: the exact law
  double regularisation = 1e-3;  // weight of an effort term, if the objective does not make u unique: make_arm_ocp()
};

struct CollocationSetup {
  Scheme scheme;
  Mesh mesh;
  Smoothing smoothing{};
  std::vector<PerLimit> margins{};      // per interval, subtracted from each limit (margins.h); empty: none
  std::vector<Joints<double>> creep{};  // [rad/s] per interval, see creep.h; empty: none
};

struct Collocated {
  CollocationSetup setup;
  SolveReport report;
  std::vector<double> durations;            // [s] of the mesh's segments
  Motion motion;                            // of the last iterate; empty if the start did not fit the problem
  double slack = 0;                         // value of the slack, if the problem has one
  Joints<double> peak{kNoLimit, kNoLimit};  // [N m] bound on |tau_m|, if the problem penalises the peak torque
};

// Returns a mesh of about `intervals` intervals, of equal length within each segment and at least two per segment.
// durations: of the segments [s].
Mesh uniform_mesh(const std::vector<double>& durations, int intervals);

// Solves the problem on the setup's mesh from a guess. A problem that cannot be solved is no error: report.status tells
// how it ended, and `motion` is that of the last iterate, if there is one.
Collocated collocate(const Problem& problem, const CollocationSetup& setup, const Guess& guess,
                     const SolveOptions& options);

// Starts from an earlier solution and its multipliers, on the same mesh or on another. If the earlier problem had other
// constraints, the solution cannot be used and the status is kFailed.
Collocated collocate(const Problem& problem, const CollocationSetup& setup, const Collocated& start,
                     const SolveOptions& options);

}  // namespace fjr
