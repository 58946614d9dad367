// One optimisation: a problem on a given mesh, with a given friction law, from a given start.
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

// By what the problem that is solved differs from the one that was asked for.
struct Smoothing {
  double friction_width = 0;     // [rad/s] of the smoothed law; 0: the exact law
  double regularisation = 1e-3;  // weight of a regularisation by effort where there is none, see make_arm_ocp()
};

struct CollocationSetup {
  Scheme scheme;
  Mesh mesh;
  Smoothing smoothing{};
  std::vector<PerLimit> margins{};      // per interval, taken off each limit (margins.h); empty: none
  std::vector<Joints<double>> creep{};  // [rad/s] per interval, see creep.h; empty: none
};

struct Collocated {
  CollocationSetup setup;
  SolveReport report;
  std::vector<double> durations;            // [s] of the mesh's segments
  Motion motion;                            // meaningful when report.solved()
  double slack = 0;                         // of a problem with slack
  Joints<double> peak{kNoLimit, kNoLimit};  // [N m] of a problem that prices the peak: what bounds |tau_m|
};

// About `intervals` intervals, equal within each segment, for segments of these durations [s].
Mesh uniform_mesh(const std::vector<double>& durations, int intervals);

Collocated collocate(const Problem& problem, const CollocationSetup& setup, const Guess& guess,
                     const SolveOptions& options);

// From an earlier solution, multipliers included, on the same mesh or on another. An earlier solution of a problem with
// other constraints is no start: the status is then kFailed.
Collocated collocate(const Problem& problem, const CollocationSetup& setup, const Collocated& start,
                     const SolveOptions& options);

}  // namespace fjr
