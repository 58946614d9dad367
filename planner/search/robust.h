// Plans motions that keep their limits also on the arms that an identification leaves possible.
#pragma once

#include <optional>
#include <string>

#include "planner/search/findings.h"

namespace fjr {

// Adds margins for those arms to the certified motion, if that is asked for. The margins are computed for the present
// motion (certificate/robust) and subtracted from its limits. That gives another motion with other margins, so this is
// repeated until margins and motion fit. If a margin is still missing at the end, the motion is not certified, and its
// certificate says so. Returns the motion without margins; nothing if none were asked for or nothing is certified.
std::optional<Publication> make_robust(const Problem& asked, Findings& found, Session& session);

// Returns by how much the objective of the robust motion `best` would be lower if the parameter had half its standard
// error. To find out, margins are added again to the motion `without` them. Returns nothing if that fails or no time is
// left.
std::optional<double> saved_by_half_the_error(const std::string& parameter, const Problem& asked,
                                              const Publication& without, const Publication& best, Session& session);

}  // namespace fjr
