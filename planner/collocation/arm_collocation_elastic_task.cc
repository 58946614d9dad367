#include "planner/analysis/arm_analysis.h"
#include "planner/collocation/arm_collocation.h"

namespace fjr {

template Collocated collocate_with<kElasticTask>(const Problem&, const CollocationSetup&, const Guess*,
                                                 const Collocated*, const SolveOptions&);
template Analysis analyse_with<kElasticTask>(const Problem&, const Collocated&, double);

}  // namespace fjr
