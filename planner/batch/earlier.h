// Recognises the results of an earlier run, which need not be planned again.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "planner/problem/problem.h"
#include "planner/search/settings.h"

namespace fjr {

// Returns the content of a file of an earlier answer by its name; nothing if it does not exist or cannot be unpacked.
using EarlierFiles = std::function<std::optional<std::string>(const std::string& name)>;

EarlierFiles files_in(const std::filesystem::path& folder);

// Returns the plan.json of an earlier answer if it is a final answer of this version to the same problem, and its files
// are complete. An answer because of a deadline or a cancellation is not final. want_uncertified: the file of an
// uncertified trajectory must exist as well. want_proven: a certificate without a proof is not final, as if the problem
// asked for a proof. If neither asks for one, an uncertified plan for which a proof was requested is not final.
// settings: those of the search; an answer with other ones is not final.
std::optional<nlohmann::ordered_json> finished_earlier(const Problem& problem, const EarlierFiles& files,
                                                       bool want_uncertified, bool want_proven = false,
                                                       const SearchSettings& settings = {});

}  // namespace fjr
