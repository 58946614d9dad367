#include "planner/analysis/arm_analysis.h"
#include "planner/collocation/arm_collocation.h"

namespace fjr {

template Collocated collocate_with<kWithPeak>(const Problem&, const CollocationSetup&, const Guess*, const Collocated*,
                                              const SolveOptions&);
template Analysis analyse_with<kWithPeak>(const Problem&, const Collocated&, double);

}  // namespace fjr
