// The chain factorisation against dense linear algebra, on random matrices with the structure of collocation KKT
// systems.
#include "planner/solver/kkt/chain_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace fjr {
namespace {

struct System {
  int size = 0, stages = 0;
  std::vector<int> rows, cols, stage;
  std::vector<double> values;

  Eigen::MatrixXd dense() const {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t e = 0; e < rows.size(); ++e) {
      a(rows[e], cols[e]) += values[e];
      if (rows[e] != cols[e]) a(cols[e], rows[e]) += values[e];
    }
    return a;
  }
};

// A chain of `stages` stages with nx node states (the first stage's start is fixed, so not there), nu controls, as many
// defects as states, nr inequality rows with slacks, and nb border variables. Indefinite Hessian blocks when
// `indefinite`.
System chain(int stages, int nx, int nu, int nr, int nb, bool indefinite, double largest_slack, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  System s;
  s.stages = stages;
  const auto index = [&s](int stage) {
    s.stage.push_back(stage);
    return s.size++;
  };
  const auto entry = [&s](int i, int j, double v) {
    s.rows.push_back(i);
    s.cols.push_back(j);
    s.values.push_back(v);
  };
  std::vector<int> border;
  for (int b = 0; b < nb; ++b) border.push_back(index(stages));
  std::vector<int> node;  // of the stage before
  for (int k = 0; k < stages; ++k) {
    std::vector<int> variables = node, u, next;
    for (int i = 0; i < nu; ++i) u.push_back(index(k));
    for (int i = 0; i < nx; ++i) next.push_back(index(k));
    variables.insert(variables.end(), u.begin(), u.end());
    variables.insert(variables.end(), next.begin(), next.end());
    for (std::size_t i = 0; i < variables.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) entry(variables[i], variables[j], 0.3 * normal(random));
      entry(variables[i], variables[i], (indefinite ? 1.0 : 6.0) + normal(random));
      for (const int b : border) entry(b, variables[i], normal(random));
    }
    for (int d = 0; d < nx; ++d) {
      const int row = index(k);
      for (const int v : variables) entry(row, v, normal(random));
      for (const int b : border) entry(row, b, normal(random));
      entry(row, row, 0);
    }
    for (int r = 0; r < nr; ++r) {
      const int slack = index(k), row = index(k);
      const bool active = r % 2 == 0;
      entry(slack, slack, active ? largest_slack : 1e-9);
      entry(row, slack, -1);
      entry(row, row, 0);
      for (const int v : u) entry(row, v, normal(random));
      for (const int v : node) entry(row, v, normal(random));
    }
    node = next;
  }
  for (const int b : border) entry(b, b, 5 + normal(random));
  return s;
}

struct Case {
  int stages, nx, nu, nr, nb;
  bool indefinite;
  double largest_slack;
};

class Chain : public testing::TestWithParam<Case> {};

TEST_P(Chain, SolvesAndCountsLikeDenseAlgebra) {
  const Case c = GetParam();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const System s = chain(c.stages, c.nx, c.nu, c.nr, c.nb, c.indefinite, c.largest_slack, seed);
    ChainLdlt factor;
    factor.analyse(s.size, s.rows, s.cols, s.stage, s.stages);
    ASSERT_TRUE(factor.factorise(s.values, 1e-2));
    const Eigen::MatrixXd a = s.dense();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(a, Eigen::EigenvaluesOnly);
    EXPECT_EQ(factor.negative_eigenvalues(), (eigen.eigenvalues().array() < 0).count());
    const Eigen::VectorXd wanted = Eigen::VectorXd::Random(s.size);
    Eigen::VectorXd x = a * wanted;
    factor.solve({x.data(), static_cast<std::size_t>(x.size())});
    // Backward error of a threshold-pivoted factorisation: growth 1/threshold^few times rounding; measured < 1e-11.
    EXPECT_LT((a * x - a * wanted).norm(), 1e-9 * (a.norm() * x.norm())) << "seed " << seed;
    // The same factor twice: no state is left over.
    ASSERT_TRUE(factor.factorise(s.values, 1e-2));
    Eigen::VectorXd again = a * wanted;
    factor.solve({again.data(), static_cast<std::size_t>(again.size())});
    EXPECT_EQ(x, again);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Chain,
                         testing::Values(Case{1, 2, 1, 0, 0, false, 1}, Case{3, 4, 2, 2, 1, false, 10},
                                         Case{12, 4, 2, 3, 1, true, 1e3}, Case{6, 8, 4, 6, 2, true, 1e7},
                                         Case{40, 3, 1, 2, 1, true, 1}));

TEST(ChainLdlt, ReportsASingularMatrix) {
  System s = chain(4, 3, 1, 1, 1, false, 1, 1);
  // Two defects of stage 2 become the same row, but for their (zero) diagonals.
  const Eigen::MatrixXd a = s.dense();
  std::vector<int> defects;
  for (int i = 0; i < s.size; ++i) {
    if (s.stage[static_cast<std::size_t>(i)] == 2 && a(i, i) == 0 && a.row(i).cwiseAbs().count() > 2)
      defects.push_back(i);
  }
  ASSERT_GE(defects.size(), 2U);
  for (std::size_t e = 0; e < s.rows.size(); ++e) {
    for (auto* side : {&s.rows, &s.cols}) {
      if ((*side)[e] == defects[1]) s.values[e] = 0;
    }
  }
  ChainLdlt factor;
  factor.analyse(s.size, s.rows, s.cols, s.stage, s.stages);
  EXPECT_FALSE(factor.factorise(s.values, 1e-2));
}

TEST(ChainLdlt, RefusesWhatIsNoChain) {
  ChainLdlt factor;
  const std::vector<int> rows{0, 1, 2, 3, 2}, cols{0, 1, 2, 3, 0}, stage{0, 1, 2, 3};
  EXPECT_THROW(factor.analyse(4, rows, cols, stage, 4), std::invalid_argument);
}

}  // namespace
}  // namespace fjr
