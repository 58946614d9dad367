// The worker's side: one request after the other, from pipe to pipe.
#pragma once

#include <filesystem>

namespace fjr {

// Reads requests from `in` and writes progress and results to `out` until `in` ends. Robot: the service's.
void solve_requests(int in, int out, const std::filesystem::path& robot);

}  // namespace fjr
