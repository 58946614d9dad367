#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kElasticTask>>;
template Collocated collocate_with<kElasticTask>(const Problem&, const CollocationSetup&, const Guess*,
                                                 const Collocated*, const SolveOptions&);

}  // namespace fjr
