#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kRateWithTask>>;
template Collocated collocate_with<kRateWithTask>(const Problem&, const CollocationSetup&, const Guess*,
                                                  const Collocated*, const SolveOptions&);

}  // namespace fjr
