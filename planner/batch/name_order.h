// The order of names in which numbers count as numbers: reach_-0.3, reach_0.5, reach_2, reach_10.
#pragma once

#include <string>

namespace fjr {

// Returns whether a comes before b (a strict total order). A minus counts as a sign only at the beginning and after
// '_', where values are in the names of a grid's points. Numbers come before words.
bool comes_before(const std::string& a, const std::string& b);

}  // namespace fjr
