#include "planner/collocation/arm_collocation.h"

namespace fjr {

template Collocated collocate_with<kElasticEverything>(const Problem&, const CollocationSetup&, const Guess*,
                                                       const Collocated*, const SolveOptions&);

}  // namespace fjr
