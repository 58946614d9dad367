// Decides which intervals of a solution's mesh are split.
#pragma once

#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"
#include "planner/search/continuation_strategy.h"
#include "planner/search/settings.h"

namespace fjr {

// What a mesh has to achieve.
struct MeshDemand {
  double tolerance;               // [rad] error of an interval; MeshSettings tell where less is allowed
  double excess_worth_splitting;  // excess over a limit, as a fraction of it, beyond which an interval is split
  bool lowers_peak = false;       // intervals are also split that exceed the peak torque that the objective minimises
};

// Of the meshes of homotopy steps, and of those that are to be certified.
MeshDemand demand_on_the_way(const ContinuationSettings& settings);
MeshDemand demand_for_certificate(const ContinuationSettings& settings, const ContinuationStrategy& strategy);

// Returns the setup, which has the mesh of the solution, with those intervals split whose error [rad] exceeds the
// tolerance (between velocities that soon follow each other a part of it: MeshSettings), that exceed a limit by much,
// or whose cost is inaccurate. If a motor reverses at its torque limit, u has to jump by the step of its friction.
// Nodes are placed on both sides of the jump, because halving would take three more rounds to come as near. For a peak
// of the torque they are also placed beside the start and the goal, where a motor begins to move or comes to rest.
CollocationSetup with_finer_mesh(const Problem& problem, const Collocated& solution, CollocationSetup setup,
                                 std::vector<double> errors, const MeshDemand& demand, const MeshSettings& settings);

// Returns the error above which intervals make up the sum of all errors but for a fraction `others_of_sum`.
double bulk_of(std::vector<double> errors, double others_of_sum);

}  // namespace fjr
