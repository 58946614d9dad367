#include "planner/collocation/collocate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "planner/collocation/arm_collocation.h"

namespace fjr {
namespace {

// The rate of u is the control only where something asks for it: two more states cost time.
bool needs_rate(const Problem& problem) {
  return problem.weights.torque_rate > 0 || problem.limits.torque_rate[0] < kNoLimit ||
         problem.limits.torque_rate[1] < kNoLimit;
}

// With the least that has room for the problem.
Collocated choose(const Problem& problem, const CollocationSetup& setup, const Guess* guess, const Collocated* start,
                  const SolveOptions& options) {
  const std::size_t rows = count_of_rows(problem.task);
  const bool task = rows > 0 || problem.goal.any_free(), peak = problem.weights.peak_torque > 0;
  const bool few = !needs_rate(problem) && rows <= static_cast<std::size_t>(kWithTask.task_rows);
  if (!task && !peak && few) return collocate_with<kPlain>(problem, setup, guess, start, options);
  if (!task && !peak) return collocate_with<kRateControlled>(problem, setup, guess, start, options);
  if (few && !peak) return collocate_with<kWithTask>(problem, setup, guess, start, options);
  if (few) return collocate_with<kWithPeak>(problem, setup, guess, start, options);
  return collocate_with<kEverything>(problem, setup, guess, start, options);
}

}  // namespace

Mesh uniform_mesh(const std::vector<double>& durations, int intervals) {
  const double whole = std::accumulate(durations.begin(), durations.end(), 0.0);
  Mesh mesh;
  for (std::size_t s = 0; s < durations.size(); ++s) {
    const int pieces = std::max(2, static_cast<int>(std::lround(durations[s] / whole * intervals)));
    for (int i = 0; i < pieces; ++i) mesh.intervals.push_back({1.0 / pieces, static_cast<int>(s)});
  }
  return mesh;
}

Collocated collocate(const Problem& problem, const CollocationSetup& setup, const Guess& guess,
                     const SolveOptions& options) {
  return choose(problem, setup, &guess, nullptr, options);
}

Collocated collocate(const Problem& problem, const CollocationSetup& setup, const Collocated& start,
                     const SolveOptions& options) {
  return choose(problem, setup, nullptr, &start, options);
}

}  // namespace fjr
