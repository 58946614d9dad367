// What an earlier run has finished, so that it need not be planned again.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "planner/problem/problem.h"

namespace fjr {

// A folder's plan.json, if it is there and whole.
std::optional<nlohmann::ordered_json> read_plan_json(const std::filesystem::path& folder);

// Whether plan.json is this version's final word on this very problem, the files that belong to it apart. A deadline or
// a cancellation is not final. want_proven: a certificate without a proof is not final, as where the problem asks for
// one; without that a refusal that a proof was asked for is not.
bool is_final(const nlohmann::ordered_json& plan, const Problem& problem, bool want_proven);

// plan.json of the folder if it is final and the files that belong to it are there and whole. want_uncertified: the
// file of a trajectory that was not certified belongs to it.
std::optional<nlohmann::ordered_json> finished_earlier(const Problem& problem, const std::filesystem::path& folder,
                                                       bool want_uncertified, bool want_proven = false);

}  // namespace fjr
