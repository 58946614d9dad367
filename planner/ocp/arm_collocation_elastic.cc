#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kElastic>>;
template Collocated collocate_with<kElastic>(const Problem&, const CollocationSetup&, const Guess*, const Collocated*,
                                             const SolveOptions&);

}  // namespace fjr
