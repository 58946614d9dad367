#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kPlain>>;
template Collocated collocate_with<kPlain>(const Problem&, const CollocationSetup&, const Guess*, const Collocated*,
                                           const SolveOptions&);

}  // namespace fjr
