// A certified motion made to keep its limits on the arms that an identification leaves possible, too.
#pragma once

#include "planner/search/findings.h"

namespace fjr {

// Where that is asked for: margins for those arms, found on the motion there is (certificate/robust), are kept free of
// its limits, which gives another motion with other margins, until they fit the motion that they came from. The plan's
// certificate tells what came of it; a motion that lacks a margin at last is not certified.
void make_robust(const Problem& asked, Findings& found, Session& session);

}  // namespace fjr
