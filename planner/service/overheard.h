// Completes the reply of another instance with facts about its trajectory from the plan.json in it.
#pragma once

#include "planner/protocol/messages.h"

namespace fjr {

// Sets rest_to_rest and errors of an overheard reply and, for a learnt motion, `learnt` and `motion`. If plan.json
// cannot be read they stay unset, and the trajectory cannot be executed.
void complete_overheard(Reply& reply);

}  // namespace fjr
