#include "planner/analysis/node_times.h"

#include <algorithm>
#include <cmath>

#include "planner/analysis/arm_analysis.h"

namespace fjr {
namespace {

template <Features F>
NodeTimes node_times_of(const Problem& problem, const Collocated& solution) {
  const auto t = arm_collocation::transcribe<F>(problem, solution.setup);
  Adjoint a;
  a.node_times = t.mesh().node_times(solution.durations);
  a.hamiltonian = hamiltonians(t, solution.report.iterate);
  a.conserved = a.hamiltonian;  // optimising the node times makes H itself constant, with its jumps by limits
  const std::vector<std::size_t> begins = arm_analysis::segment_begins(problem, t.mesh());
  NodeTimes result{hamiltonian(a, begins).spread, allowed_spread(solution.report.objective, a.node_times.back()), {}};
  for (std::size_t k = 1; k < a.hamiltonian.size(); ++k) {
    const bool jumps = std::abs(a.conserved[k] - a.conserved[k - 1]) > result.allowed;
    if (jumps && !std::binary_search(begins.begin(), begins.end(), k)) result.jumps.push_back(k);
  }
  return result;
}

}  // namespace

NodeTimes node_times(const Problem& problem, const Collocated& solution) {
  return with_features(problem, [&]<Features F>() { return node_times_of<F>(problem, solution); });
}

}  // namespace fjr
