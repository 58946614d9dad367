// What somebody may have meant who misspelt a word of a list.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fjr {

// How many letters have to be left out, put in, replaced or exchanged with their neighbour to make one word of the
// other (optimal string alignment: R. Lowrance, R. Wagner, J. ACM 22(2), 1975, without repeated edits of one place).
std::size_t edit_distance(std::string_view a, std::string_view b);

// The nearest of `known`, where it is near enough to have been meant: within a third of its letters. "" where none is.
std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& known);

// "; did you mean goal?", to stand behind a message; "" where nothing is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known);

}  // namespace fjr
