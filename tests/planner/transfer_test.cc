// A solution carried to another mesh is nearly one there, multipliers included.
#include "planner/collocation/transfer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "planner/nlp/solve.h"
#include "planner/search/refinement.h"
#include "tests/support/plants.h"

namespace fjr {
namespace {

using Eigen::VectorXd;

// Van der Pol's oscillator to the origin with bounded control and, unless `row` is below -0.5, an active row on the
// state.
Transcription<VanDerPol> oscillator(const Scheme& scheme, const Mesh& mesh, double row) {
  VanDerPol ocp;
  ocp.bounds[0].u_lower = {-0.1};
  ocp.bounds[0].u_upper = {1};
  ocp.bounds[0].row_lower[1] = row;
  ocp.at_nodes = {{0, {0, 1}, {0, 1}}, {mesh.size(), {0, 0}, {0, 0}}};
  ocp.durations = {{5, 5}};
  return {ocp, scheme, mesh};
}

Iterate cold_start(const Transcription<VanDerPol>& nlp) {
  Iterate start{VectorXd::Zero(nlp.variables()), {}, {}, {}};
  start.x(nlp.duration_at(0)) = 5;
  return start;
}

// The optimum on a mesh of 40 intervals.
struct Solved {
  Transcription<VanDerPol> nlp;
  Iterate iterate;
};

Solved solved(const Scheme& scheme, double row) {
  auto nlp = oscillator(scheme, equal_intervals(40), row);
  const SolveReport report = solve(nlp, cold_start(nlp), SolveOptions{});
  EXPECT_TRUE(report.solved());
  return {std::move(nlp), report.iterate};
}

double largest(const VectorXd& v) { return v.cwiseAbs().maxCoeff(); }

class TransferOf : public testing::TestWithParam<Scheme> {};

TEST_P(TransferOf, ASolutionToItsOwnMeshIsTheIdentity) {
  const auto [nlp, old] = solved(GetParam(), -0.4);
  ASSERT_GT(old.z_lower.maxCoeff(), 1e-2);  // the control is on its bound somewhere
  const Iterate same = Transfer<VanDerPol>(nlp, old, nlp).run();
  // States come from the polynomial, which misses the stages by the defects (1e-9, the solver's constraint tolerance).
  EXPECT_LT(largest(same.x - old.x), 2e-9);
  // Products and quotients with weights, and one solution with a matrix of condition 100: roundings.
  EXPECT_LT(largest(same.lambda - old.lambda), 1e-12 * (1 + largest(old.lambda)));
  EXPECT_LT(largest(same.z_lower - old.z_lower), 1e-12);
  EXPECT_LT(largest(same.z_upper - old.z_upper), 1e-12);
}

TEST_P(TransferOf, ASolutionToASplitMeshIsAGoodStart) {
  const auto [coarse, old] = solved(GetParam(), -0.4);
  const auto fine = oscillator(GetParam(), split(coarse.mesh(), std::vector<int>(40, 2)), -0.4);
  const SolveReport cold = solve(fine, cold_start(fine), SolveOptions{});
  SolveOptions options;
  options.beginning = Beginning::kMultipliers;
  options.initial_barrier = 1e-6;
  const SolveReport warm = solve(fine, Transfer<VanDerPol>(coarse, old, fine).run(), options);
  ASSERT_EQ(warm.status, SolveStatus::kOptimal);
  EXPECT_NEAR(warm.objective, cold.objective, 1e-5 * cold.objective);  // the same optimum, to the solver's 1e-6
  // Measured, warm against cold: trapezoidal 4 and 14, hermite-simpson 4 and 12, lobatto4 4 and 14, radau3 6 and 17.
  EXPECT_LT(warm.iterations, cold.iterations / 2) << "cold: " << cold.iterations;
}

// Pieces of different sizes: states from the polynomial, multipliers near those that belong there.
TEST_P(TransferOf, ASolutionToAMixedMeshIsNearItsOptimum) {
  const auto [coarse, old] = solved(GetParam(), -0.6);
  std::vector<int> pieces(40, 2);
  for (const std::size_t k : {3, 11, 12}) pieces[k] = 4;
  for (const std::size_t k : {0, 7, 39}) pieces[k] = 1;
  const auto fine = oscillator(GetParam(), split(coarse.mesh(), pieces), -0.6);
  const SolveReport optimum = solve(fine, cold_start(fine), SolveOptions{});
  ASSERT_TRUE(optimum.solved());
  const Iterate moved = Transfer<VanDerPol>(coarse, old, fine).run();
  // Multipliers are interpolated linearly at best. Measured 0.03 (trapezoidal: its costate is constant on an interval)
  // and below 0.013 (the others).
  EXPECT_LT(largest(moved.lambda - optimum.iterate.lambda), 0.05 * largest(optimum.iterate.lambda));
  // The controls' bound sets in within an interval: up to its corner they agree to the coarse mesh's own error.
  EXPECT_LT(largest(moved.x - optimum.iterate.x), 0.1);
  VectorXd defects(fine.constraints());
  fine.constraint_values(moved.x, defects);
  const auto beyond = (fine.g_lower - defects).cwiseMax(defects - fine.g_upper);
  EXPECT_LT(beyond.maxCoeff(), GetParam().order > 2 ? 1e-5 : 1e-4);  // local errors; measured 3e-6, 3e-5
}

// A multiplier of the wrong sign costs an interior-point method more than one of the wrong size.
TEST_P(TransferOf, MultipliersOfBoundsKeepTheirSign) {
  const auto [coarse, old] = solved(GetParam(), -0.4);
  const auto fine = oscillator(GetParam(), split(coarse.mesh(), std::vector<int>(40, 4)), -0.4);
  const Iterate moved = Transfer<VanDerPol>(coarse, old, fine).run();
  EXPECT_GE(moved.z_lower.minCoeff(), 0);
  EXPECT_GE(moved.z_upper.minCoeff(), 0);
  EXPECT_TRUE(moved.x.allFinite() && moved.lambda.allFinite());
}

// Sums of densities times weights: splitting leaves the total force of a bound as it is.
TEST_P(TransferOf, MultipliersOfControlBoundsKeepTheirSum) {
  const auto [coarse, old] = solved(GetParam(), -0.4);
  const auto fine = oscillator(GetParam(), split(coarse.mesh(), std::vector<int>(40, 2)), -0.4);
  const Iterate moved = Transfer<VanDerPol>(coarse, old, fine).run();
  const auto sum = [](const Transcription<VanDerPol>& nlp, const VectorXd& z) {
    double total = 0;
    for (int k = 0; k < nlp.intervals(); ++k) total += z(nlp.u_at(k, 0)) + z(nlp.u_at(k, 1));
    return total;
  };
  // Linear between the ends of an interval, and the weights are those of the linear basis: roundings.
  EXPECT_NEAR(sum(fine, moved.z_lower), sum(coarse, old.z_lower), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(All, TransferOf, testing::ValuesIn(all_schemes()),
                         [](const auto& test) { return identifier(test.param.name); });

}  // namespace
}  // namespace fjr
