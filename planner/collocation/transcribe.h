// The arm's problem as an Nlp: what collocate() solves, for those who want to look at a solution's multipliers.
#pragma once

#include "planner/collocation/collocate.h"
#include "planner/collocation/transcription.h"
#include "planner/problem/arm_ocp.h"

namespace fjr {

// The rate of u is the control only where something asks for it: two more states cost time.
bool needs_rate(const Problem& problem);

// kRate: as needs_rate() says.
template <bool kRate>
Transcription<ArmOcp<kRate>> transcribe(const Problem& problem, const CollocationSetup& setup);

}  // namespace fjr
