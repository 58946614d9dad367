#include "planner/ocp/arm_collocation.h"

namespace fjr {

template class Transcription<ArmOcp<kWithPeak>>;
template Collocated collocate_with<kWithPeak>(const Problem&, const CollocationSetup&, const Guess*, const Collocated*,
                                              const SolveOptions&);

}  // namespace fjr
