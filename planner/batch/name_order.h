// The order of names in which numbers count as numbers: reach_-0.3, reach_0.5, reach_2, reach_10.
#pragma once

#include <string>

namespace fjr {

// Whether a comes before b; of two different names one always does. A minus is a sign at the beginning and after '_',
// where values stand in the names of a grid's points; numbers come before words.
bool comes_before(const std::string& a, const std::string& b);

}  // namespace fjr
