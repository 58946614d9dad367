// The main loop of a solving process: reads requests from a pipe and writes results to another.
#pragma once

#include <filesystem>

namespace fjr {

struct WorkerSettings {
  std::filesystem::path robot;
  std::size_t warm_plans = 0;     // earlier plans kept, to start neighbouring ones from
  std::filesystem::path library;  // the folder of a plan library; empty: none
  std::size_t jobs = 1;           // threads that a request is planned with
  double rehearsal = 0;           // [s] to wait instead of planning, with the result "not converged"; 0: it plans
};

// Reads requests from `in` and writes progress and results to `out` until `in` ends.
void solve_requests(int in, int out, const WorkerSettings& settings);

}  // namespace fjr
