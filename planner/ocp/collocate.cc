#include "planner/ocp/collocate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "planner/ocp/arm_collocation.h"

namespace fjr {
namespace {

Collocated choose(const Problem& problem, const CollocationSetup& setup, const Guess* guess, const Collocated* start,
                  const SolveOptions& options) {
  const auto run = [&]<Features F>() { return collocate_with<F>(problem, setup, guess, start, options); };
  return problem.variation.slack ? with_slack_features(problem, run) : with_features(problem, run);
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
