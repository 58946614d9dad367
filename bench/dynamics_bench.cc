// The arm's equations of motion: plain, with first and with second derivatives in the ten inputs of a collocation
// point. Two states take turns.
#include <benchmark/benchmark.h>

#include "common/dual.h"
#include "model/dynamics.h"
#include "model/parameters.h"

namespace fjr::bench {
namespace {

constexpr int kInputs = kStates + kControls;

template <class T>
T input(double value, [[maybe_unused]] int i) {
  if constexpr (std::is_same_v<T, double>) {
    return value;
  } else {
    return T::input(value, i);
  }
}

template <class T>
std::array<T, kInputs> point(double shift) {
  std::array<T, kInputs> x;
  for (int i = 0; i < kInputs; ++i) x[static_cast<std::size_t>(i)] = input<T>(0.1 * (i + 1) + shift, i);
  return x;
}

template <class T>
void compensated(benchmark::State& state) {
  const Parameters robot = load_parameters(default_robot_file());
  const std::array<std::array<T, kInputs>, 2> points{point<T>(0), point<T>(0.3)};
  std::size_t turn = 0;
  for ([[maybe_unused]] auto _ : state) {
    const auto& x = points[turn ^= 1];
    benchmark::DoNotOptimize(
        compensated_dynamics(robot, State<T>::from(x.data()), Joints<T>{x[kStates], x[kStates + 1]}));
  }
}

// With the exact friction law: what a rollout evaluates.
void exact(benchmark::State& state) {
  const Parameters robot = load_parameters(default_robot_file());
  const std::array<std::array<double, kInputs>, 2> points{point<double>(0), point<double>(0.3)};
  std::size_t turn = 0;
  for ([[maybe_unused]] auto _ : state) {
    const auto& x = points[turn ^= 1];
    benchmark::DoNotOptimize(
        dynamics(robot, State<double>::from(x.data()), Joints<double>{x[kStates], x[kStates + 1]}));
  }
}

BENCHMARK(compensated<double>)->Name("compensated");
BENCHMARK(compensated<Dual<kInputs>>)->Name("compensated_first_derivatives");
BENCHMARK(compensated<Dual2<kInputs>>)->Name("compensated_second_derivatives");
BENCHMARK(exact);

}  // namespace
}  // namespace fjr::bench

BENCHMARK_MAIN();
