// The chain factorisation against dense linear algebra and against MUMPS, on random matrices with the structure of
// collocation KKT systems.
#include "planner/nlp/chain/chain_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <thread>

#include "bench/mumps.h"
#include "tests/planner/allocations.h"

namespace fjr {
namespace {

using Outcome = ChainLdlt::Outcome;

struct System {
  int size = 0;
  ChainStructure structure;
  std::vector<int> rows, cols;
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

struct Case {
  const char* what;
  int blocks = 6, nx = 4, nu = 2, nr = 3, nb = 1;  // states, controls, inequality rows per block; border
  double curvature = 6;         // of the Hessian's diagonal; the rest is about 1: below 2 or so it is indefinite
  double largest_slack = 10;    // curvature of the slacks of active rows
  double regularisation = 0;    // of the equality rows,
  int regularised = 1;          // every so manieth
  double largest_bound = 0;     // added to some of the diagonal: variables at their bounds
  double spread = 0;            // rows and columns are multiplied by up to 10^spread, and down to its inverse
  bool end_given = false;       // no states at the end: more rows than variables there
  bool equalities_told = true;  // otherwise every index is like any other
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.what; }

// The first block's start is fixed, so not there; as many defects as states.
System chain(const Case& c, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  System s;
  s.structure.blocks = c.blocks;
  const auto index = [&](int block, bool equality = false) {
    s.structure.block.push_back(block);
    s.structure.equality.push_back(equality && c.equalities_told);
    return s.size++;
  };
  const auto entry = [&s](int i, int j, double v) {
    s.rows.push_back(i);
    s.cols.push_back(j);
    s.values.push_back(v);
  };
  std::vector<int> border;
  for (int b = 0; b < c.nb; ++b) border.push_back(index(c.blocks));
  std::vector<int> node;  // of the block before
  for (int k = 0; k < c.blocks; ++k) {
    std::vector<int> variables = node, u, next;
    for (int i = 0; i < c.nu; ++i) u.push_back(index(k));
    for (int i = 0; i < c.nx && !(c.end_given && k + 1 == c.blocks); ++i) next.push_back(index(k));
    variables.insert(variables.end(), u.begin(), u.end());
    variables.insert(variables.end(), next.begin(), next.end());
    for (std::size_t i = 0; i < variables.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) entry(variables[i], variables[j], 0.3 * normal(random));
      entry(variables[i], variables[i], c.curvature + normal(random));
      if (i % 3 == 0) entry(variables[i], variables[i], c.largest_bound);
      for (const int b : border) entry(b, variables[i], normal(random));
    }
    for (int d = 0; d < c.nx; ++d) {
      const int row = index(k, true);
      for (const int v : variables) entry(row, v, normal(random));
      for (const int b : border) entry(row, b, normal(random));
      entry(row, row, row % c.regularised == 0 ? -c.regularisation : 0);
    }
    for (int r = 0; r < c.nr; ++r) {
      const int slack = index(k), row = index(k);
      const bool active = r % 2 == 0;
      entry(slack, slack, active ? c.largest_slack : 1e-9);
      entry(row, slack, -1);
      entry(row, row, 0);
      for (const int v : u) entry(row, v, normal(random));
      for (const int v : node) entry(row, v, normal(random));
      for (const int b : border) {
        if (r % 3 == 1) entry(row, b, normal(random));
      }
    }
    node = next;
  }
  for (const int b : border) entry(b, b, 5 + normal(random));
  std::vector<double> scale;
  for (int i = 0; i < s.size; ++i) scale.push_back(std::pow(10, c.spread * uniform(random)));
  for (std::size_t e = 0; e < s.rows.size(); ++e) {
    s.values[e] *= scale[static_cast<std::size_t>(s.rows[e])] * scale[static_cast<std::size_t>(s.cols[e])];
  }
  return s;
}

ChainLdlt analysed(const System& s) {
  ChainLdlt factor;
  factor.analyse(s.rows, s.cols, s.structure);
  return factor;
}

// |A x - b| as a share of |A| |x| + |b|, the normwise backward error.
double backward_error(const Eigen::MatrixXd& a, const Eigen::VectorXd& x, const Eigen::VectorXd& b) {
  return (a * x - b).norm() / (a.norm() * x.norm() + b.norm());
}

std::span<double> span(Eigen::VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

void on_two_threads(const std::function<void()>& one, const std::function<void()>& other) {
  const std::jthread second(other);
  one();
}

void the_other_first(const std::function<void()>& one, const std::function<void()>& other) {
  other();
  one();
}

class Chain : public testing::TestWithParam<Case> {};

TEST_P(Chain, SolvesAndCountsLikeDenseAlgebraAndMumps) {
  double at_once = 0, once_refined = 0, of_mumps = 0;  // worst backward errors
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const System s = chain(GetParam(), seed);
    ChainLdlt factor = analysed(s);
    ASSERT_EQ(factor.factorise(s.values, 1e-8), Outcome::kDone) << "seed " << seed;
    const Eigen::MatrixXd a = s.dense();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(a, Eigen::EigenvaluesOnly);
    // Eigenvalues that rounding could carry to the other side are no reference.
    const double rounding = 1e-14 * eigen.eigenvalues().cwiseAbs().maxCoeff();
    if (eigen.eigenvalues().cwiseAbs().minCoeff() > rounding) {
      EXPECT_EQ(factor.negative_eigenvalues(), (eigen.eigenvalues().array() < 0).count()) << "seed " << seed;
    }

    bench::Mumps mumps(s.size, s.rows, s.cols, s.values);
    ASSERT_TRUE(mumps.factorise());
    EXPECT_EQ(factor.negative_eigenvalues(), mumps.negative_eigenvalues()) << "seed " << seed;
    const int negative = factor.negative_eigenvalues();
    ASSERT_NE(factor.factorise(s.values, 1e-8, negative - 1), Outcome::kSingular);
    EXPECT_GE(factor.negative_eigenvalues(), negative) << "seed " << seed;
    ASSERT_EQ(factor.factorise(s.values, 1e-8, negative), Outcome::kDone);
    EXPECT_EQ(factor.negative_eigenvalues(), negative) << "seed " << seed;

    const Eigen::VectorXd b = a * Eigen::VectorXd::Random(s.size);
    const auto solved = [&](auto& by) {
      Eigen::VectorXd x = b;
      by.solve(span(x));
      return x;
    };
    const auto refined = [&](auto& by) {  // once, as Ipopt does at least
      const Eigen::VectorXd x = solved(by);
      Eigen::VectorXd rest = b - a * x;
      by.solve(span(rest));
      return Eigen::VectorXd(x + rest);
    };
    const Eigen::VectorXd x = solved(factor);
    at_once = std::max(at_once, backward_error(a, x, b));
    once_refined = std::max(once_refined, backward_error(a, refined(factor), b));
    of_mumps = std::max(of_mumps, backward_error(a, refined(mumps), b));

    // The same factor twice: no state is left over, and nothing is allocated.
    Eigen::VectorXd again = b;
    const long before = allocations();
    const Outcome outcome = factor.factorise(s.values, 1e-8);
    factor.solve(span(again));
    EXPECT_EQ(allocations(), before);
    EXPECT_EQ(outcome, Outcome::kDone);
    EXPECT_EQ(x, again);

    // Both halves at once: not a bit is another.
    ChainLdlt halved = analysed(s);
    again = b;
    ASSERT_EQ(halved.factorise(s.values, 1e-8, negative, on_two_threads), Outcome::kDone);
    halved.solve(span(again), on_two_threads);
    EXPECT_EQ(x, again);
    EXPECT_EQ(halved.factorisation_work(), factor.factorisation_work());
  }
  // Of a factorisation with threshold pivots: growth, measured up to 1e7 on these, times rounding; and one refinement
  // leaves its square of it.
  EXPECT_LT(at_once, 1e-8);
  EXPECT_LT(once_refined, std::max(1e-15, 10 * of_mumps));
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, Chain,
    testing::Values(
        Case{.what = "one block", .blocks = 1, .nx = 2, .nu = 1, .nr = 0, .nb = 0},
        Case{.what = "two blocks", .blocks = 2}, Case{.what = "short", .blocks = 3, .nr = 2},
        Case{.what = "long", .blocks = 40, .nx = 3, .nu = 1, .nr = 2},
        Case{.what = "as wide as the arm", .blocks = 8, .nx = 16, .nu = 4, .nr = 10},
        Case{.what = "wider than any unrolled loop", .blocks = 4, .nx = 30, .nu = 10, .nr = 10, .nb = 4},
        Case{.what = "wrong inertia", .blocks = 12, .curvature = 1},
        Case{.what = "without curvature", .blocks = 12, .curvature = 0},
        Case{.what = "active rows", .nx = 8, .nu = 4, .nr = 6, .nb = 2, .curvature = 1, .largest_slack = 1e9},
        Case{.what = "active bounds", .nx = 8, .nu = 4, .largest_bound = 1e9},
        Case{.what = "regularised rows", .nx = 8, .curvature = 1, .regularisation = 1e-6},
        Case{.what = "some rows regularised",
             .blocks = 20,
             .nx = 4,
             .nu = 1,
             .nr = 0,
             .regularisation = 1e-2,
             .regularised = 9},
        Case{.what = "end given", .nx = 6, .nu = 2, .end_given = true},
        Case{.what = "end given, few controls", .blocks = 20, .nx = 6, .nu = 1, .nr = 0, .end_given = true},
        Case{.what = "badly scaled", .nx = 6, .curvature = 1, .spread = 3},
        Case{.what = "equalities unknown", .blocks = 12, .nx = 8, .curvature = 1, .equalities_told = false},
        Case{.what = "many borders", .blocks = 12, .nx = 5, .nb = 6}),
    [](const auto& param) {
      std::string name = param.param.what;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
      return name;
    });

// Two defects of block 2 say the same but for a difference of this size.
System nearly_singular(double difference) {
  System s = chain({.what = "", .blocks = 4, .nx = 3, .nu = 2, .nr = 1}, 1);
  std::vector<int> defects;
  for (int i = 0; i < s.size; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (s.structure.block[at] == 2 && s.structure.equality[at]) defects.push_back(i);
  }
  const Eigen::MatrixXd a = s.dense();
  bool first = true;
  for (std::size_t e = 0; e < s.rows.size(); ++e) {
    if (s.rows[e] != defects[1] || s.cols[e] == defects[1]) continue;
    s.values[e] = a(defects[0], s.cols[e]) + (first ? difference : 0);
    first = false;
  }
  return s;
}

// As many negative eigenvalues as rows are what a minimum has; negative curvature in one block is known there: of the
// half from the start nothing but the blocks before it was needed, of the half from the end those of the other half
// too.
TEST(ChainLdlt, StopsWhereTheInertiaIsKnownToBeWrong) {
  const Case convex{.what = "convex", .blocks = 40};
  const System s = chain(convex, 1);
  const auto rows = convex.blocks * (convex.nx + convex.nr);
  ChainLdlt factor = analysed(s);
  ASSERT_EQ(factor.factorise(s.values, 1e-8, rows), Outcome::kDone);
  EXPECT_EQ(factor.negative_eigenvalues(), rows);
  const double whole = factor.factorisation_work();
  const struct {
    int block;
    double of_work;
  } places[] = {{4, 0.15}, {19, 0.55}, {35, 0.65}};
  for (const auto& place : places) {
    std::vector<double> values = s.values;
    for (std::size_t e = 0; e < s.rows.size(); ++e) {  // of a control
      const bool own = s.rows[e] == s.cols[e] && s.structure.block[static_cast<std::size_t>(s.rows[e])] == place.block;
      if (!own || values[e] < 1) continue;
      values[e] = -1e3;
      break;
    }
    ASSERT_EQ(factor.factorise(values, 1e-8, rows), Outcome::kTooManyNegative);
    const int negative = factor.negative_eigenvalues();
    const double work = factor.factorisation_work();
    EXPECT_GT(negative, rows) << "block " << place.block;
    EXPECT_LT(work, place.of_work * whole) << "block " << place.block;
    for (const DoBoth& both : {DoBoth(the_other_first), DoBoth(on_two_threads)}) {  // whichever half is sooner
      ASSERT_EQ(factor.factorise(values, 1e-8, rows, both), Outcome::kTooManyNegative);
      EXPECT_EQ(factor.negative_eigenvalues(), negative) << "block " << place.block;
      EXPECT_EQ(factor.factorisation_work(), work) << "block " << place.block;
    }
  }
}

TEST(ChainLdlt, ReportsASingularMatrix) {
  for (const double difference : {0.0, 1e-15}) {
    const System s = nearly_singular(difference);
    EXPECT_EQ(analysed(s).factorise(s.values, 1e-8), Outcome::kSingular) << difference;
  }
}

TEST(ChainLdlt, ReportsAnEmptyRow) {
  System s = nearly_singular(1);
  for (std::size_t e = 0; e < s.rows.size(); ++e) {
    if (s.rows[e] == s.rows.back() || s.cols[e] == s.rows.back()) s.values[e] = 0;  // the border
  }
  EXPECT_EQ(analysed(s).factorise(s.values, 1e-8), Outcome::kSingular);
}

TEST(ChainLdlt, SolvesANearlySingularMatrix) {
  const System s = nearly_singular(1e-8);
  ChainLdlt factor = analysed(s);
  ASSERT_EQ(factor.factorise(s.values, 1e-8), Outcome::kDone);
  const Eigen::MatrixXd a = s.dense();
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(s.size);
  Eigen::VectorXd x = b;
  factor.solve(span(x));
  EXPECT_LT(backward_error(a, x, b), 1e-13);
  EXPECT_GT(x.cwiseAbs().maxCoeff(), 1e6);  // it is nearly singular
}

// As met with 800 intervals: rows of active constraints that see only states near their bounds, which go later.
TEST(DenseLdlt, EliminatesWhatWouldPileUp) {
  constexpr int kRows = 30, kLater = 3, kAll = kRows + kLater;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.3, 1);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(kAll, kAll);
  for (int i = 0; i < kRows; ++i) {
    a(i, i) = -1e-9;
    for (int j = kRows; j < kAll; ++j) a(i, j) = a(j, i) = uniform(random);
  }
  for (int j = kRows; j < kAll; ++j) a(j, j) = 1e10;
  std::vector<int> index(kAll);
  std::iota(index.begin(), index.end(), 0);
  DenseLdlt factor;
  factor.reset(index);
  for (int i = 0; i < kAll; ++i) Eigen::Map<Eigen::RowVectorXd>(factor.row(i), kAll) = a.row(i);
  const int negative = factor.eliminate(kRows, 1e-8);
  EXPECT_LE(kRows - factor.pivots(), 16);  // as many as a block may leave
  EXPECT_EQ(negative, factor.pivots());

  const int p = factor.pivots();
  const Eigen::MatrixXd kept = a(factor.index(), factor.index());
  const Eigen::MatrixXd schur = kept.bottomRightCorner(kAll - p, kAll - p) - kept.bottomLeftCorner(kAll - p, p) *
                                                                                 kept.topLeftCorner(p, p).inverse() *
                                                                                 kept.topRightCorner(p, kAll - p);
  for (int i = p; i < kAll; ++i) {
    for (int j = p; j < kAll; ++j)
      EXPECT_NEAR(factor.row(i)[j], schur(i - p, j - p), 1e-12 * 1e10);  // rounding of the largest
  }
}

TEST(ChainLdlt, RefusesWhatIsNoChain) {
  ChainLdlt factor;
  const std::vector<int> rows{0, 1, 2, 3, 2}, cols{0, 1, 2, 3, 0};
  EXPECT_THROW(factor.analyse(rows, cols, {4, {0, 1, 2, 3}, {}}), std::invalid_argument);
}

}  // namespace
}  // namespace fjr
