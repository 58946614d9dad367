// One factorisation of the arm's KKT matrix: ours along the chain against MUMPS on the same matrix, values only (the
// analysis is done once per mesh). Counter: time per interval.
#include <benchmark/benchmark.h>

#include "bench/arm_nlp.h"
#include "bench/mumps.h"
#include "model/parameters.h"
#include "planner/nlp/chain/chain_ldlt.h"

namespace fjr::bench {
namespace {

Kkt arm_kkt(benchmark::State& state) {
  const ArmTranscription nlp = arm_nlp(load_parameters(default_robot_file()), static_cast<int>(state.range(0)));
  state.counters["per_interval"] = benchmark::Counter(
      static_cast<double>(state.range(0)), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  return kkt_of(nlp, some_point(nlp));
}

void chain_factorise(benchmark::State& state) {
  const Kkt kkt = arm_kkt(state);
  ChainLdlt factor;
  factor.analyse(kkt.rows, kkt.cols, kkt.structure);
  for ([[maybe_unused]] auto _ : state) {
    if (factor.factorise(kkt.values, 1e-8) != ChainLdlt::Outcome::kDone) state.SkipWithError("singular");
  }
}

void chain_solve(benchmark::State& state) {
  const Kkt kkt = arm_kkt(state);
  ChainLdlt factor;
  factor.analyse(kkt.rows, kkt.cols, kkt.structure);
  factor.factorise(kkt.values, 1e-8);
  Eigen::VectorXd b = Eigen::VectorXd::Ones(kkt.size);
  for ([[maybe_unused]] auto _ : state) {
    b.setOnes();
    factor.solve({b.data(), static_cast<std::size_t>(b.size())});
  }
}

void mumps_factorise(benchmark::State& state) {
  const Kkt kkt = arm_kkt(state);
  Mumps mumps(kkt.size, kkt.rows, kkt.cols, kkt.values);
  for ([[maybe_unused]] auto _ : state) {
    if (!mumps.factorise()) state.SkipWithError("MUMPS failed");
  }
}

BENCHMARK(chain_factorise)->RangeMultiplier(2)->Range(25, 800);
BENCHMARK(chain_solve)->Arg(100);
BENCHMARK(mumps_factorise)->RangeMultiplier(2)->Range(25, 800);

}  // namespace
}  // namespace fjr::bench

BENCHMARK_MAIN();
