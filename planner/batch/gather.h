// A packed batch as a whole: its progress, its table of results, and its plans as folders.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/batch/manifest.h"
#include "planner/batch/statuses.h"

namespace fjr {

struct BatchProgress {
  std::size_t requests = 0;
  StatusCounts statuses;  // of the requests
  std::size_t chunks = 0, under_way = 0;
  std::vector<std::size_t> unfinished;  // chunks with requests that are open or failed
  std::size_t runs = 0, planned = 0;    // number of runs over chunks, and of requests planned in them
};

// Answers to an earlier request, robot or version of fjr do not count; their requests are open.
BatchProgress look_at(const Manifest& manifest);

nlohmann::ordered_json to_json(const BatchProgress& progress);

// "1-3,7", as sbatch --array takes it.
std::string in_ranges(const std::vector<std::size_t>& numbers);

// Writes DIR/results.sqlite: table `results` with the columns of summary.csv (table.h) and `chunk`, in the order of the
// names; table `units` with the columns' units. The file replaces an earlier one when it is complete.
void gather(const Manifest& manifest);

// Writes the folder that `fjr plan` would have written: the result's files, the request as NAME.yaml, and in `previous`
// the certified plan that this one has replaced, if there is one. Throws InputError for a name that is none of the
// batch's, and for a request without an answer.
void unpack(const Manifest& manifest, const std::string& name, const std::filesystem::path& folder);

}  // namespace fjr
