// What another instance's reply leaves unsaid of its trajectory, read from the plan.json within.
#pragma once

#include "planner/protocol/messages.h"

namespace fjr {

// Sets rest_to_rest, errors, and for rows that were learnt learnt and motion, of a reply that was heard; left as they
// are, it cannot be executed.
void complete_overheard(Reply& reply);

}  // namespace fjr
