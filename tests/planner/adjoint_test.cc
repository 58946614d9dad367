// Costates, Hamiltonian and stationarity from the multipliers: closed forms of Pontryagin's conditions.
#include "planner/collocation/adjoint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "planner/analysis/optimality.h"
#include "planner/search/refinement.h"
#include "tests/support/double_integrator_problems.h"

namespace fjr {
namespace {

using Eigen::VectorXd;
using namespace double_integrator_problems;

SolveReport solved(const Plant& nlp, double duration) {
  SolveReport report = solve(nlp, zeros(nlp, duration), exact());
  EXPECT_EQ(report.status, SolveStatus::kOptimal);
  return report;
}

Optimality::Hamiltonian along(const Adjoint& a) { return hamiltonian(a, {0, a.hamiltonian.size()}); }

class AdjointOf : public testing::TestWithParam<Scheme> {};

// Whatever the point and the multipliers: a longer motion is one with longer intervals.
TEST_P(AdjointOf, TheMeanHamiltonianIsTheDerivativeByTheDuration) {
  VanDerPol ocp;
  ocp.time_weight = 0.7;
  ocp.bounds[0].row_lower = {-1, -1, -1};
  ocp.durations = {{1, 3}};
  Mesh mesh{{{0.2, 0}, {0.5, 0}, {0.3, 0}}};
  const Transcription<VanDerPol> nlp(ocp, GetParam(), mesh);
  std::mt19937_64 random(7);
  const auto any = [&random](Eigen::Index size) {
    return VectorXd::NullaryExpr(size, [&] { return std::ldexp(static_cast<double>(random() >> 11), -52) - 1; }).eval();
  };
  Iterate point{any(nlp.variables()), any(nlp.constraints()), {}, {}};
  point.x(nlp.duration_at(0)) = 2;
  const Adjoint a = adjoint(nlp, point);
  EXPECT_NEAR(ocp.time_weight + along(a).mean, a.lagrangian(nlp.duration_at(0)), 1e-12);  // roundings
  const auto value = [&](const VectorXd& x) {
    VectorXd g(nlp.constraints());
    nlp.constraint_values(x, g);
    return nlp.objective(x) + point.lambda.dot(g);
  };
  for (Eigen::Index i = 0; i < nlp.variables(); ++i) {
    VectorXd less = point.x, more = point.x;
    less(i) -= 1e-5;
    more(i) += 1e-5;
    EXPECT_NEAR(a.lagrangian(i), (value(more) - value(less)) / 2e-5, 1e-8);  // third derivatives of order 10, roundings
  }
}

// u = 6 d / T^2 (1 - 2 t / T), p2 = -2 u, p1 = -p2' = -24 d / T^3; J = 12 d^2 / T^3.
TEST_P(AdjointOf, MinimumEffortHasLinearCostates) {
  constexpr double d = 0.8, T = 1.7, p1 = -24 * d / (T * T * T);
  const int intervals = GetParam().order > 2 ? 5 : 200;
  // Order 2: relative error 2 / n^2, measured; higher orders: no discretisation error, only the solver's.
  const double tolerance = GetParam().order > 2 ? 1e-8 : 1e-4;
  const Plant nlp = gentlest(GetParam(), intervals, d, T);
  const Iterate optimum = solved(nlp, T).iterate;
  const Adjoint a = adjoint(nlp, optimum);
  const auto h = along(a);
  EXPECT_NEAR(h.mean, -36 * d * d / std::pow(T, 4), 10 * tolerance);  // dJ/dT, the duration being fixed
  EXPECT_LT(h.spread, 10 * tolerance);
  for (int k = 0; k < intervals; ++k) {
    const Eigen::MatrixXd p = costates(nlp, optimum.lambda, k);
    for (int j = 0; j < nlp.scheme().stages(); ++j) {
      const double t = (k + GetParam().points(j)) * T / intervals, u = 6 * d / (T * T) * (1 - 2 * t / T);
      EXPECT_NEAR(p(j, 0), p1, 10 * tolerance);
      // Order 2: constant on an interval, so right in its middle.
      EXPECT_NEAR(p(j, 1), -2 * u, GetParam().order > 2 ? 1e-8 : -p1 * T / intervals);
    }
  }
  // Start and goal are fixed variables: derivatives of J by them.
  EXPECT_NEAR(a.lagrangian(nlp.node_at(0)), p1, 10 * tolerance);
  EXPECT_NEAR(a.lagrangian(nlp.node_at(0) + 1), -12 * d / (T * T), 10 * tolerance);
  EXPECT_NEAR(a.lagrangian(nlp.node_at(intervals)), -p1, 10 * tolerance);
  const auto s = stationarity(nlp, optimum, a);
  EXPECT_LT(s.free, 1e-8);
  EXPECT_EQ(s.free > 0, s.largest > 0);
}

// T = 2, p1 = -1, p2 = t - 1, u = -sign p2, H = -1.
TEST_P(AdjointOf, MinimumTimeHasTheHamiltonianMinusOne) {
  constexpr int kIntervals = 10;
  const Plant nlp = fastest(GetParam(), kIntervals, 0.1, 10);
  const Iterate optimum = solved(nlp, 3).iterate;
  const Adjoint a = adjoint(nlp, optimum);
  const auto h = along(a);
  // States are parabolas and costates lines, the switch is a node; the trapezoidal rule has p2 constant on an interval,
  // and with it H = -1 in the mean of every one. What is left is the solver's 1e-10 by the size of its multipliers.
  EXPECT_NEAR(h.mean, -1, 1e-7);
  EXPECT_LT(h.spread, 1e-7);
  EXPECT_LT(h.largest, 1e-7);
  EXPECT_NEAR(a.lagrangian(0), -1, 1e-7);
  EXPECT_NEAR(a.lagrangian(1), -1, 1e-7);
  EXPECT_NEAR(a.lagrangian(nlp.node_at(kIntervals)), 1, 1e-7);
  EXPECT_NEAR(a.lagrangian(nlp.node_at(kIntervals) + 1), -1, 1e-7);
  const auto s = stationarity(nlp, optimum, a);
  EXPECT_EQ(s.wrong, 0);
  EXPECT_LT(s.residual, 1e-8);
  // p2 near the ends, averaged over the first control's share of the stages: at least that of half an interval inside.
  EXPECT_LE(s.largest, 1);
  EXPECT_GE(s.largest, 1 - 1.0 / kIntervals);
}

// On the arc at the limit x and v stand still and u = 0: H = 0 there, and so everywhere, though p1 jumps at its ends.
TEST_P(AdjointOf, BrysonDenhamHasTheHamiltonianZero) {
  for (const bool as_row : {false, true}) {
    const Plant nlp = bryson_denham(GetParam(), 24, 1.0 / 9, as_row);
    const Iterate optimum = solved(nlp, 1).iterate;
    const auto h = along(adjoint(nlp, optimum));
    // At the start u^2 / 2 = 18. Measured 5e-5, the solver's tolerance times its multipliers; order 2: 0.03.
    EXPECT_NEAR(h.mean, 0, GetParam().order > 2 ? 1e-4 : 0.1) << as_row;
    EXPECT_LT(h.spread, GetParam().order > 2 ? 1e-4 : 0.1) << as_row;
  }
}

// Where the mesh asks x <= l at instants that the optimum does not touch, H jumps by what these instants are worth.
// That is nearly all it jumps by: u is continuous, and the time of no node matters otherwise.
TEST_P(AdjointOf, WhereLimitsAreAskedIsNoReasonForTheHamiltonianToVary) {
  Mesh mesh{{{0.45, 0}, {0.55, 0}}};  // no point at the single touch, which is at 0.5
  for (int i = 0; i < 3; ++i) mesh = split(mesh, std::vector<int>(mesh.size(), 2));
  for (const bool as_row : {false, true}) {
    const Plant equal = bryson_denham(GetParam(), 16, 0.2, as_row);
    const Plant nlp(equal.ocp(), GetParam(), mesh);
    // Measured 4e-16 to 0.0035; without that part 0.13, 0.02, 0.002 and 0.04.
    EXPECT_LT(along(adjoint(nlp, solved(nlp, 1).iterate)).spread, 5e-3) << as_row;
  }
}

// One multiplier that is off by a per cent is seen.
TEST_P(AdjointOf, AWrongMultiplierShows) {
  const Plant nlp = gentlest(GetParam(), 20, 0.8, 1.7);
  Iterate optimum = solved(nlp, 1.7).iterate;
  const auto spread = [&] { return along(adjoint(nlp, optimum)).spread; };
  const auto slope = [&] { return stationarity(nlp, optimum, adjoint(nlp, optimum)).free; };
  const double good_spread = spread(), good_slope = slope();
  optimum.lambda(nlp.defect_row(3, GetParam().stages() - 1, 1)) *= 1.01;
  EXPECT_GT(spread(), 10 * good_spread);
  EXPECT_GT(slope(), 1e4 * good_slope);
}

INSTANTIATE_TEST_SUITE_P(All, AdjointOf, testing::ValuesIn(all_schemes()),
                         [](const auto& test) { return identifier(test.param.name); });

}  // namespace
}  // namespace fjr
