#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kEverything>>;
template Collocated collocate_with<kEverything>(const Problem&, const CollocationSetup&, const Guess*,
                                                const Collocated*, const SolveOptions&);

}  // namespace fjr
