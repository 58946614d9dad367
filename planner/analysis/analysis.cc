#include "planner/analysis/analysis.h"

#include "planner/analysis/arm_analysis.h"

namespace fjr {

Analysis analyse(const Problem& problem, const Collocated& solution, double scale) {
  return with_features(problem, [&]<Features F>() { return analyse_with<F>(problem, solution, scale); });
}

}  // namespace fjr
