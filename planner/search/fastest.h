// The fastest motion of a request with another objective. Stretched to the allowed time it is a start for the request;
// if it takes too long, the request has no solution.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "planner/search/continuation.h"
#include "planner/search/findings.h"
#include "planner/search/search.h"
#include "planner/search/settings.h"

namespace fjr {

// Returns the request with time as its objective and a free duration; via points may be passed at any time.
Problem fastest_of(Problem problem);

// Returns the minimum-time problem that ends at via point i. Times of earlier via points are kept; what comes after is
// dropped.
Problem fastest_to_via(Problem problem, std::size_t i);

// Returns the fastest motion to via point i on a coarse mesh with smoothed friction (fastest_to_via), the best of those
// from the usual guesses and from the way on which the fastest motion to the goal passes it. Returns nothing if no
// motion there is found.
std::optional<Continuation> sketch_to_via(const Problem& problem, std::size_t i, Search& search);

// Returns whether the fastest motion of an alternative seems to take longer than is allowed. This is decided by a
// sketch, whose duration is some per cent longer than the final one: it is a reason to look closer, and no verdict.
// Arms that have to swing up are not judged. The sketch is kept for try_from_fastest(), unless its
// mesh is coarser than that of a start.
bool seems_too_short(const std::shared_ptr<const Problem>& alternative, Findings& found, Session& session);

// Finds the fastest motion of an alternative, with the exact friction law, because a smoothed motion may take some per
// cent longer. If it takes no longer than allowed, the alternative is solved from it; if that fails, on its mesh.
void try_from_fastest(const std::shared_ptr<const Problem>& alternative, Findings& found, Session& session);

// Returns whether the fastest motion is known and the allowed duration is hardly longer.
bool has_little_spare_time(const Findings& found, const FastestSettings& settings);

// Solves the alternative on the fastest motion's own mesh with the exact friction law. With hardly any time to spare,
// no other mesh and no smoothed law has a solution.
void adopt_fastest(Findings& found, Session& session);

}  // namespace fjr
