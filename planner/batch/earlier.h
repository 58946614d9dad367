// What an earlier run has finished, so that it need not be planned again.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "planner/problem/problem.h"

namespace fjr {

// What is in one of the files of an earlier answer, by its name. None where it is not there, or cannot be unpacked.
using EarlierFiles = std::function<std::optional<std::string>(const std::string& name)>;

EarlierFiles files_in(const std::filesystem::path& folder);

// plan.json of an earlier answer if it is this version's final word on this very problem, and the files that belong to
// it are there and whole. A deadline or a cancellation is not final. want_uncertified: the file of a trajectory that
// was not certified belongs to it. want_proven: a certificate without a proof is not final, as where the problem asks
// for one; without that a refusal that a proof was asked for is not.
std::optional<nlohmann::ordered_json> finished_earlier(const Problem& problem, const EarlierFiles& files,
                                                       bool want_uncertified, bool want_proven = false);

}  // namespace fjr
