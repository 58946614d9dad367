#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kRateControlled>>;
template Collocated collocate_with<kRateControlled>(const Problem&, const CollocationSetup&, const Guess*,
                                                    const Collocated*, const SolveOptions&);

}  // namespace fjr
