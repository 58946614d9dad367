// All starts of a request, and what is tried where none of them leads anywhere.
#pragma once

#include "planner/search/findings.h"

namespace fjr {

// Every start on a coarse mesh, four at a time once one led somewhere; what converges to something promising is refined
// while the next four are tried, which do not depend on it: so what so many starts come to, more of them come to as
// well. count: of starts; 0: as many as the request's `search` and its objective say.
void find_motions(int count, Findings& found, Session& session);

}  // namespace fjr
