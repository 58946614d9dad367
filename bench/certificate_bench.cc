// The certificate of a planned reach, and its parts: the rollouts in open and closed loop, those from beside the start
// with the second after their ends, that second alone, and the prediction of the run on the hardware.
#include <benchmark/benchmark.h>

#include <stdexcept>

#include "model/parameters.h"
#include "planner/certificate/certificate.h"
#include "planner/certificate/comparison.h"
#include "planner/certificate/limits.h"
#include "planner/certificate/perturbed.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/tracking.h"
#include "planner/plan.h"
#include "planner/request/request.h"

namespace fjr::bench {
namespace {

struct Planned {
  Parameters robot = load_parameters(default_robot_file());
  Limits limits = Limits::of(robot);
  Trajectory trajectory;

  Planned() {
    const Problem problem = parse_request("start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\n", "reach", robot);
    const Plan result = plan(problem, {});
    if (result.status != PlanStatus::kCertified) throw std::runtime_error("the reach is not certified");
    trajectory = *result.trajectory;
  }
};

const Planned& planned() {
  static const Planned once;
  return once;
}

Comparison rolled_out(const Drive& drive) {
  const auto& [robot, limits, trajectory] = planned();
  Rollout rollout(robot, rollout_allowance(robot, limits), Accuracy::of_certificates());
  return compare(rollout, robot, trajectory, drive, comparison_instants(trajectory));
}

void whole(benchmark::State& state) {
  const auto& [robot, limits, trajectory] = planned();
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(certify(robot, limits, trajectory));
}
void open_loop(benchmark::State& state) {
  const Drive drive = Drive::open_loop(planned().trajectory);
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(rolled_out(drive));
}
void closed_loop(benchmark::State& state) {
  const Drive drive = Drive::closed_loop(planned().trajectory, planned().robot);
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(rolled_out(drive));
}
void perturbed_starts(benchmark::State& state) {
  const auto& [robot, limits, trajectory] = planned();
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(roll_out_perturbed(robot, trajectory));
}
void held_after_end(benchmark::State& state) {
  const auto& [robot, limits, trajectory] = planned();
  const State<double> closed = rolled_out(Drive::closed_loop(trajectory, robot)).final;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(deviation_at_rest(robot, trajectory.samples.back(), closed));
  }
}
void tracking_prediction(benchmark::State& state) {
  const auto& [robot, limits, trajectory] = planned();
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(predict_tracking(robot, trajectory));
}

BENCHMARK(whole)->Unit(benchmark::kMillisecond);
BENCHMARK(open_loop)->Unit(benchmark::kMillisecond);
BENCHMARK(closed_loop)->Unit(benchmark::kMillisecond);
BENCHMARK(perturbed_starts)->Unit(benchmark::kMillisecond);
BENCHMARK(held_after_end)->Unit(benchmark::kMillisecond);
BENCHMARK(tracking_prediction)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fjr::bench

BENCHMARK_MAIN();
