// One factorisation of the arm's KKT matrix: ours along the chain against MUMPS on the same matrix, values only (the
// analysis is done once per mesh). Counter: time per interval.
#include <benchmark/benchmark.h>
#include <dmumps_c.h>

#include "bench/arm_nlp.h"
#include "model/parameters.h"
#include "planner/solver/kkt/chain_ldlt.h"

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
  factor.analyse(kkt.size, kkt.rows, kkt.cols, kkt.stage, kkt.stages);
  for ([[maybe_unused]] auto _ : state) {
    if (!factor.factorise(kkt.values, 1e-8)) state.SkipWithError("singular");
  }
}

void chain_solve(benchmark::State& state) {
  const Kkt kkt = arm_kkt(state);
  ChainLdlt factor;
  factor.analyse(kkt.size, kkt.rows, kkt.cols, kkt.stage, kkt.stages);
  factor.factorise(kkt.values, 1e-8);
  Eigen::VectorXd b = Eigen::VectorXd::Ones(kkt.size);
  for ([[maybe_unused]] auto _ : state) {
    b.setOnes();
    factor.solve({b.data(), static_cast<std::size_t>(b.size())});
  }
}

// MUMPS as Ipopt uses it: symmetric indefinite, sequential.
class Mumps {
 public:
  explicit Mumps(const Kkt& kkt) : rows_(kkt.rows), cols_(kkt.cols), values_(kkt.values) {
    for (int& i : rows_) ++i;
    for (int& i : cols_) ++i;
    data_.sym = 2;
    data_.par = 1;
    data_.comm_fortran = -987654;
    run(-1);
    for (const int output : {0, 1, 2, 3}) data_.icntl[output] = 0;  // silent
    data_.icntl[13] = 1000;                                         // more work space than estimated, as Ipopt grants
    data_.n = kkt.size;
    data_.nz = static_cast<int>(values_.size());
    data_.irn = rows_.data();
    data_.jcn = cols_.data();
    data_.a = values_.data();
    run(1);
  }
  ~Mumps() { run(-2); }
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  bool factorise() {
    run(2);
    return data_.info[0] >= 0;
  }

 private:
  void run(int job) {
    data_.job = job;
    dmumps_c(&data_);
  }

  std::vector<int> rows_, cols_;
  std::vector<double> values_;
  DMUMPS_STRUC_C data_{};
};

void mumps_factorise(benchmark::State& state) {
  Mumps mumps(arm_kkt(state));
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
