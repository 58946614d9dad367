#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kElasticEverything>>;
template Collocated collocate_with<kElasticEverything>(const Problem&, const CollocationSetup&, const Guess*,
                                                       const Collocated*, const SolveOptions&);

}  // namespace fjr
