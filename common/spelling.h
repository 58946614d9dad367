// Suggests words of a list for a misspelt word.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fjr {

// Returns the number of letters that must be deleted, inserted, replaced or exchanged with their neighbour to turn one
// word into the other (optimal string alignment: R. Lowrance, R. Wagner, J. ACM 22(2), 1975, without repeated edits of
// one place).
std::size_t edit_distance(std::string_view a, std::string_view b);

// Returns the nearest word of `known`, if it differs by one letter or by at most a third of the letters of the shorter
// of both; otherwise "".
std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& known);

// Returns "; did you mean goal?" to be appended to a message, or "" if no word is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known);

}  // namespace fjr
