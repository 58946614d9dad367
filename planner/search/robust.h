// A certified motion made to keep its limits on the arms that an identification leaves possible, too.
#pragma once

#include <optional>
#include <string>

#include "planner/search/findings.h"

namespace fjr {

// Where that is asked for: margins for those arms, found on the motion there is (certificate/robust), are kept free of
// its limits, which gives another motion with other margins, until they fit the motion that they came from. The plan's
// certificate tells what came of it; a motion that lacks a margin at last is not certified. Returns the motion that
// there was; none where nothing is asked for.
std::optional<Publication> make_robust(const Problem& asked, Findings& found, Session& session);

// How much less the objective of the robust motion `best` would be if that parameter had half its standard error:
// margins are added again to the motion `without` them. None where they cannot be had, or there is no time left.
std::optional<double> saved_by_half_the_error(const std::string& parameter, const Problem& asked,
                                              const Publication& without, const Publication& best, Session& session);

}  // namespace fjr
