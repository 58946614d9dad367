// All starts of a request, and what is tried where none of them leads anywhere.
#pragma once

#include "planner/search/findings.h"

namespace fjr {

// What is done where no start leads anywhere: whatever else may lead to a motion or tell why there is none, or nothing.
enum class IfNone { kFallBack, kGiveUp };

// Solves every start on a coarse mesh, four at a time once one has found a motion. Promising motions are refined while
// the next four starts are solved. These do not depend on the refinement, so that a search with more starts repeats all
// results of one with fewer. count: of starts; 0: as many as the request's `search` and its objective say.
void find_motions(int count, IfNone if_none, Findings& found, Session& session);

}  // namespace fjr
