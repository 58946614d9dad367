// One iteration of Ipopt on the first problem of a reach (minimum time, smooth friction, uniform mesh): time of the
// first 30, transcription apart, over their number. Counters: microseconds an iteration spends in each part.
#include <benchmark/benchmark.h>

#include "model/parameters.h"
#include "planner/ocp/collocate.h"
#include "planner/request/request.h"
#include "planner/search/guesses.h"

namespace fjr::bench {
namespace {

void iteration(benchmark::State& state, const char* linear_solver) {
  const Problem problem =
      parse_request("start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\n", "reach", load_parameters(default_robot_file()));
  const Guess guess = straight_guess(problem, duration_guess(problem));
  const CollocationSetup setup{
      hermite_simpson(), uniform_mesh(guess.durations, static_cast<int>(state.range(0))), {0.1, 0.1}};
  SolveOptions options;
  options.linear_solver = linear_solver;
  options.max_iterations = 30;
  SolveCost cost;
  int iterations = 0;
  for ([[maybe_unused]] auto _ : state) {
    const SolveReport report = collocate(problem, setup, guess, options).report;
    state.SetIterationTime(report.cost.total / report.iterations);
    cost += report.cost;
    iterations += report.iterations;
  }
  state.counters["evaluation_us"] = 1e6 * cost.evaluation / iterations;
  state.counters["linear_algebra_us"] = 1e6 * cost.linear_algebra / iterations;
  state.counters["ipopt_us"] = 1e6 * cost.in_optimiser() / iterations;
}

void sizes(benchmark::internal::Benchmark* b) {
  b->Arg(25)->Arg(100)->Arg(400)->UseManualTime()->Iterations(3)->Unit(benchmark::kMicrosecond);  // 3 solves
}
BENCHMARK_CAPTURE(iteration, stage, "stage")->Apply(sizes);
BENCHMARK_CAPTURE(iteration, mumps, "mumps")->Apply(sizes);

}  // namespace
}  // namespace fjr::bench

BENCHMARK_MAIN();
