// Collocation tables: the conditions that define them, and the order that they promise, observed.
#include "planner/collocation/scheme.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/support/plants.h"

namespace fjr {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Entries below one made of sums of at most four terms and one inverse of a 4 x 4 Vandermonde matrix (condition 100).
constexpr double kRounding = 1e-13;

class Schemes : public testing::TestWithParam<Scheme> {};

TEST_P(Schemes, PointsIncreaseToTheEnd) {
  const Scheme s = GetParam();
  EXPECT_EQ(s.points(s.stages() - 1), 1);
  for (Eigen::Index i = 0; i + 1 < s.points.size(); ++i) EXPECT_LT(s.points(i), s.points(i + 1));
  EXPECT_EQ(s.starts_at_node, s.points(0) == 0);
}

// Hairer, Norsett & Wanner, condition C(s): sum_j A(i,j) c_j^(k-1) = c_i^k / k for k <= s. Rows summing to c is k = 1.
TEST_P(Schemes, StagesIntegratePolynomialsOfTheirDegree) {
  const Scheme s = GetParam();
  for (int k = 1; k <= s.stages(); ++k) {
    for (int i = 0; i < s.stages(); ++i) {
      double sum = 0;
      for (int j = 0; j < s.stages(); ++j) sum += s.A(i, j) * std::pow(s.points(j), k - 1);
      EXPECT_NEAR(sum, std::pow(s.points(i), k) / k, kRounding) << i << ", " << k;
    }
  }
}

// Condition B(p): the quadrature is exact up to degree order - 1, and no further.
TEST_P(Schemes, QuadratureHasTheOrderOfTheScheme) {
  const Scheme s = GetParam();
  const auto miss = [&](int k) {
    double sum = -1.0 / k;
    for (int j = 0; j < s.stages(); ++j) sum += s.b(j) * std::pow(s.points(j), k - 1);
    return std::abs(sum);
  };
  for (int k = 1; k <= s.order; ++k) EXPECT_LT(miss(k), kRounding) << k;
  EXPECT_GT(miss(s.order + 1), 1e-4);
}

TEST_P(Schemes, EndOfTheIntervalIsItsLastStage) {
  const Scheme s = GetParam();
  EXPECT_NEAR(s.b.sum(), 1, kRounding);
  EXPECT_LT((s.A.row(s.stages() - 1).transpose() - s.b).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_GT(s.b.minCoeff(), 0);  // costs and densities are divided by it
}

TEST_P(Schemes, LagrangeBasisIsOneAtItsOwnPoint) {
  const Scheme s = GetParam();
  for (int j = 0; j < s.stages(); ++j) {
    for (int i = 0; i < s.stages(); ++i) {
      double value = 0;
      for (int d = 0; d < s.stages(); ++d) value += s.lagrange(j, d) * std::pow(s.points(i), d);
      EXPECT_NEAR(value, i == j ? 1 : 0, kRounding);
    }
  }
}

TEST_P(Schemes, ControlsAreLinearBetweenTheEnds) {
  const Scheme s = GetParam();
  for (int j = 0; j < s.stages(); ++j) {
    EXPECT_DOUBLE_EQ(s.control_fraction(j, 0), 1 - s.points(j));
    EXPECT_DOUBLE_EQ(s.control_fraction(j, 1), s.points(j));
  }
}

// ---- order ----

// Error at t = 1/4 of y' = 2 pi cos(2 pi t) y, y(0) = 1, y(1/4) = e, in `steps` steps: each is one linear solve.
double linear_error(const Scheme& s, int steps) {
  using std::numbers::pi;
  const double h = 0.25 / steps;
  double y = 1;
  for (int k = 0; k < steps; ++k) {
    MatrixXd system = MatrixXd::Identity(s.stages(), s.stages());
    for (int j = 0; j < s.stages(); ++j) {
      system.col(j) -= h * 2 * pi * std::cos(2 * pi * h * (k + s.points(j))) * s.A.col(j);
    }
    const VectorXd stages = system.lu().solve(VectorXd::Constant(s.stages(), y));
    y = stages(s.stages() - 1);
  }
  return std::abs(y - std::numbers::e);
}

// Error at t = 2 of the logistic y' = y (1 - y), y(0) = 1/10, y(t) = 1 / (1 + 9 e^-t): Newton in every step.
double logistic_error(const Scheme& s, int steps) {
  const double h = 2.0 / steps;
  double y = 0.1;
  for (int k = 0; k < steps; ++k) {
    VectorXd stages = VectorXd::Constant(s.stages(), y);
    for (int newton = 0; newton < 10; ++newton) {
      const VectorXd f = stages.array() * (1 - stages.array()), slope = 1 - 2 * stages.array();
      const VectorXd residual = stages - VectorXd::Constant(s.stages(), y) - h * s.A * f;
      stages -= (MatrixXd::Identity(s.stages(), s.stages()) - h * s.A * slope.asDiagonal()).lu().solve(residual);
    }
    y = stages(s.stages() - 1);
  }
  return std::abs(y - 1 / (1 + 9 * std::exp(-2.0)));
}

TEST_P(Schemes, HalvingTheStepDividesTheErrorByTwoToTheOrder) {
  const Scheme s = GetParam();
  // 0.15: what is left of the next power of h at these steps (measured: at most 0.08). The errors are above 1e-12.
  EXPECT_NEAR(std::log2(linear_error(s, 8) / linear_error(s, 16)), s.order, 0.15);
  EXPECT_NEAR(std::log2(logistic_error(s, 8) / logistic_error(s, 16)), s.order, 0.15);
}

INSTANTIATE_TEST_SUITE_P(All, Schemes, testing::ValuesIn(all_schemes()),
                         [](const auto& test) { return identifier(test.param.name); });

// ---- names ----

TEST(FindScheme, FindsEverySchemeByItsName) {
  for (const Scheme& s : all_schemes()) {
    const Scheme found = find_scheme(s.name);
    EXPECT_EQ(found.name, s.name);
    EXPECT_EQ(found.A, s.A);
  }
}

TEST(FindScheme, ListsTheNamesThereAre) {
  try {
    find_scheme("euler");
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "no collocation scheme 'euler'; there are trapezoidal, hermite-simpson, lobatto4, radau3");
  }
}

}  // namespace
}  // namespace fjr
