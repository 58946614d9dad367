// Evaluation of the arm's NLP: what every iteration of the optimiser asks for. Counter: time per interval.
#include <benchmark/benchmark.h>

#include <array>

#include "bench/arm_nlp.h"
#include "model/parameters.h"

namespace fjr::bench {
namespace {

template <class Evaluate>
void per_interval(benchmark::State& state, Evaluate&& evaluate) {
  const ArmTranscription nlp = arm_nlp(load_parameters(default_robot_file()), static_cast<int>(state.range(0)));
  // Two points take turns: the transcription keeps what it derived at the last one.
  const std::array<Eigen::VectorXd, 2> points{some_point(nlp), 1.01 * some_point(nlp)};
  std::size_t turn = 0;
  for ([[maybe_unused]] auto _ : state) evaluate(nlp, points[turn ^= 1]);
  state.counters["per_interval"] = benchmark::Counter(
      static_cast<double>(state.range(0)), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void constraints(benchmark::State& state) {
  per_interval(state, [](const ArmTranscription& nlp, const Eigen::VectorXd& z) {
    Eigen::VectorXd g(nlp.constraints());
    nlp.constraint_values(z, g);
    benchmark::DoNotOptimize(g.data());
  });
}
void gradient(benchmark::State& state) {
  per_interval(state, [](const ArmTranscription& nlp, const Eigen::VectorXd& z) {
    Eigen::VectorXd g(nlp.variables());
    nlp.gradient(z, g);
    benchmark::DoNotOptimize(g.data());
  });
}
void jacobian(benchmark::State& state) {
  per_interval(state, [](const ArmTranscription& nlp, const Eigen::VectorXd& z) {
    Eigen::VectorXd values(nlp.jacobian_pattern.size());
    nlp.jacobian(z, values);
    benchmark::DoNotOptimize(values.data());
  });
}
void hessian(benchmark::State& state) {
  per_interval(state, [](const ArmTranscription& nlp, const Eigen::VectorXd& z) {
    const Eigen::VectorXd multipliers = Eigen::VectorXd::Ones(nlp.constraints());
    Eigen::VectorXd values(nlp.hessian_pattern.size());
    nlp.hessian(z, 1, multipliers, values);
    benchmark::DoNotOptimize(values.data());
  });
}

BENCHMARK(constraints)->Arg(100);
BENCHMARK(gradient)->Arg(100);
BENCHMARK(jacobian)->Arg(100);
BENCHMARK(hessian)->Arg(100);

}  // namespace
}  // namespace fjr::bench

BENCHMARK_MAIN();
