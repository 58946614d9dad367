// The fastest motion of a request with another objective: a start for it, stretched to the time it has; or the reason
// why it has none.
#pragma once

#include "planner/search/findings.h"

namespace fjr {

// The same request for the fastest motion, whatever time it takes, via points passed at any time.
Problem fastest_of(Problem problem);

// The fastest motion through via point i, to end there: the times of those before it kept, whatever comes after.
Problem fastest_to_via(Problem problem, std::size_t i);

// The fastest motion of an alternative, with the exact friction law, for a smoothed motion may take some per cent
// longer. Where it takes no longer than allowed, it is the start of the alternative; where nothing comes of that, its
// own mesh is.
void try_from_fastest(const std::shared_ptr<const Problem>& alternative, Findings& found, Session& session);

// There is a fastest motion, and hardly more time than it takes.
bool has_little_spare_time(const Findings& found);

// With hardly any time to spare only the fastest motion's own mesh and the exact law have a motion.
void adopt_fastest(Findings& found, Session& session);

}  // namespace fjr
