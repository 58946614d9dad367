// Optima with closed forms through the same transcription and solver as the arm's, and what the Ipopt adapter reports.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "planner/nlp/solve.h"
#include "tests/support/double_integrator_problems.h"

namespace fjr {
namespace {

using Eigen::VectorXd;
using namespace double_integrator_problems;

class Optimum : public testing::TestWithParam<Scheme> {};

TEST_P(Optimum, MinimumTimeOfADoubleIntegratorIsBangBang) {
  const Plant nlp = fastest(GetParam(), 10, 0.1, 10);
  const SolveReport report = solve(nlp, zeros(nlp, 3), exact());
  ASSERT_EQ(report.status, SolveStatus::kOptimal);
  // The switch at half time is a node, states are parabolas: no discretisation error, only the solver's 1e-10.
  EXPECT_NEAR(report.objective, 2, 1e-8);
  EXPECT_NEAR(nlp.durations(report.iterate.x)[0], 2, 1e-8);
  for (int k = 0; k < nlp.intervals(); ++k) {
    for (int end = 0; end < 2; ++end) EXPECT_NEAR(report.iterate.x(nlp.u_at(k, end)), k < 5 ? 1 : -1, 1e-6);
  }
}

TEST_P(Optimum, MinimumEffortOfADoubleIntegratorIsLinear) {
  constexpr double kDistance = 0.8, kDuration = 1.7,
                   kOptimum = 12 * kDistance * kDistance / (kDuration * kDuration * kDuration);
  const auto objective = [](int intervals) {
    const Plant nlp = gentlest(GetParam(), intervals, kDistance, kDuration);
    const SolveReport report = solve(nlp, zeros(nlp, kDuration), exact());
    EXPECT_EQ(report.status, SolveStatus::kOptimal);
    const double u_begin = report.iterate.x(nlp.u_at(0, 0));
    if (GetParam().order > 2) {
      EXPECT_NEAR(u_begin, 6 * kDistance / (kDuration * kDuration), 1e-8);
    }
    return report.objective;
  };
  if (GetParam().order > 2) {  // cubic states, quadratic cost: no discretisation error
    EXPECT_NEAR(objective(4), kOptimum, 1e-9);
  } else {  // order 2: four times closer with twice the intervals, up to the next power of h
    EXPECT_NEAR((objective(8) - kOptimum) / (objective(16) - kOptimum), 4, 0.1);
    EXPECT_NEAR(objective(64), kOptimum, 1e-3 * kOptimum);
  }
}

TEST_P(Optimum, BrysonDenhamWithTheStateBoundedAsAVariableOrAsARow) {
  constexpr double kL = 1.0 / 9;  // the arc on the bound begins at 1/3 and ends at 2/3: nodes of the mesh
  for (const bool as_row : {false, true}) {
    const Plant nlp = bryson_denham(GetParam(), 24, kL, as_row);
    const SolveReport report = solve(nlp, zeros(nlp, 1), exact());
    ASSERT_EQ(report.status, SolveStatus::kOptimal);
    // Order 2: measured 1.6e-2. Higher orders: the solver's tolerance.
    EXPECT_NEAR(report.objective, 4 / (9 * kL), GetParam().order > 2 ? 1e-8 : 2e-2) << as_row;
    for (int k = 0; k <= nlp.intervals(); ++k) EXPECT_LE(report.iterate.x(nlp.node_at(k)), kL + 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Optimum, testing::ValuesIn(all_schemes()),
                         [](const auto& test) { return identifier(test.param.name); });

// ---- the adapter ----

TEST(Ipopt, ReportsWhatItFound) {
  const Plant nlp = gentlest(hermite_simpson(), 6, 1, 1);
  const SolveReport report = solve(nlp, zeros(nlp, 1), SolveOptions{});
  EXPECT_TRUE(report.solved());
  EXPECT_EQ(report.objective, nlp.objective(report.iterate.x));
  EXPECT_LE(report.violation, SolveOptions{}.constraint_tolerance);
  EXPECT_GT(report.iterations, 0);
  EXPECT_EQ(report.iterate.lambda.size(), nlp.constraints());
  EXPECT_EQ(report.iterate.z_lower.size(), nlp.variables());
}

// Every iteration factorises and evaluates; with MUMPS the factorisations are not seen, but their time is.
TEST(Ipopt, TellsWhatASolveCost) {
  const Plant nlp = fastest(hermite_simpson(), 50, 0.1, 10);
  for (const char* linear_solver : {"stage", "mumps"}) {
    SolveOptions options;
    options.linear_solver = linear_solver;
    const SolveReport report = solve(nlp, zeros(nlp, 3), options);
    ASSERT_TRUE(report.solved());
    EXPECT_GT(report.cost.evaluation, 0);
    EXPECT_GT(report.cost.linear_algebra, 0);
    if (options.linear_solver == "stage") {
      EXPECT_GT(report.cost.in_optimiser(),
                0);  // MUMPS is timed by the process's clock, with threads that BLAS may have
      EXPECT_GE(report.cost.factorisations, report.iterations);
    } else {
      EXPECT_EQ(report.cost.factorisations, 0);
    }
  }
}

TEST(Ipopt, StopsWhenTheMonitorSaysSo) {
  const Plant nlp = fastest(hermite_simpson(), 10, 0.1, 10);
  SolveOptions options;
  std::vector<int> seen;
  options.monitor = [&seen](const IterationInfo& info) {
    seen.push_back(info.iteration);
    return info.iteration < 3;
  };
  const SolveReport report = solve(nlp, zeros(nlp, 3), options);
  EXPECT_EQ(report.status, SolveStatus::kStopped);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_EQ(seen, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_FALSE(report.solved());
}

TEST(Ipopt, ReportsInfeasibility) {
  const Plant nlp = fastest(hermite_simpson(), 10, 1, 1);  // half the time it takes
  const SolveReport report = solve(nlp, zeros(nlp, 1), SolveOptions{});
  EXPECT_EQ(report.status, SolveStatus::kInfeasible);
  EXPECT_GT(report.violation, 1e-3);
}

TEST(Ipopt, ReportsTheIterationLimit) {
  const Plant nlp = fastest(hermite_simpson(), 10, 0.1, 10);
  SolveOptions options;
  options.max_iterations = 2;
  const SolveReport report = solve(nlp, zeros(nlp, 3), options);
  EXPECT_EQ(report.status, SolveStatus::kIterationLimit);
  EXPECT_EQ(report.iterations, 2);
}

TEST(Ipopt, ReportsBreakdown) {
  const Plant nlp = fastest(hermite_simpson(), 10, 0.1, 10);
  Iterate start = zeros(nlp, 3);
  start.x(5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solve(nlp, start, SolveOptions{}).status, SolveStatus::kFailed);
}

TEST(Ipopt, NamesEveryStatus) {
  EXPECT_STREQ(name(SolveStatus::kOptimal), "optimal");
  EXPECT_STREQ(name(SolveStatus::kAcceptable), "acceptable");
  EXPECT_STREQ(name(SolveStatus::kInfeasible), "infeasible");
  EXPECT_STREQ(name(SolveStatus::kIterationLimit), "iteration_limit");
  EXPECT_STREQ(name(SolveStatus::kStopped), "stopped");
  EXPECT_STREQ(name(SolveStatus::kFailed), "failed");
}

TEST(Ipopt, GivesTheSameBitsTwice) {
  const Plant nlp = bryson_denham(hermite_simpson(), 24, 0.1, true);
  const SolveReport a = solve(nlp, zeros(nlp, 1), SolveOptions{}), b = solve(nlp, zeros(nlp, 1), SolveOptions{});
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.objective, b.objective);
  EXPECT_EQ(a.iterate.x, b.iterate.x);
  EXPECT_EQ(a.iterate.lambda, b.iterate.lambda);
  EXPECT_EQ(a.iterate.z_lower, b.iterate.z_lower);
  EXPECT_EQ(a.iterate.z_upper, b.iterate.z_upper);
}

// A start at the optimum, with its multipliers, is recognised at once; without them it is not.
TEST(Ipopt, WarmStartTakesTheMultipliers) {
  const Plant nlp = bryson_denham(hermite_simpson(), 24, 0.1, true);
  const SolveReport cold = solve(nlp, zeros(nlp, 1), SolveOptions{});
  ASSERT_TRUE(cold.solved());
  SolveOptions options;
  options.beginning = Beginning::kMultipliers;
  options.initial_barrier = 1e-8;
  const SolveReport warm = solve(nlp, cold.iterate, options);
  EXPECT_EQ(warm.status, SolveStatus::kOptimal);
  EXPECT_LE(warm.iterations, 1);  // measured: 0
  EXPECT_GT(cold.iterations, 5);
}

}  // namespace
}  // namespace fjr
