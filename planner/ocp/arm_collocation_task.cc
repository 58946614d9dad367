#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kWithTask>>;
template Collocated collocate_with<kWithTask>(const Problem&, const CollocationSetup&, const Guess*, const Collocated*,
                                              const SolveOptions&);

}  // namespace fjr
