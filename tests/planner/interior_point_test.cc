// Our interior-point method: published optima, Ipopt's own answers, and how it ends where it cannot go on.
#include "planner/nlp/interior_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "common/dual.h"
#include "planner/nlp/ipopt.h"
#include "planner/nlp/kkt_system.h"
#include "planner/nlp/quadratic_program.h"
#include "planner/nlp/slack_form.h"
#include "tests/support/double_integrator_problems.h"
#include "tests/support/published_problems.h"

namespace fjr {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using namespace double_integrator_problems;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMost = 7;  // variables of a small problem

// A problem of few variables without structure: functions[0] is the objective, the others are the constraints.
using Scalar = Dual2<kMost>;
using Function = std::function<Scalar(const std::array<Scalar, kMost>& x)>;

class SmallProblem : public Nlp {
 public:
  SmallProblem(std::vector<std::array<double, 2>> x, std::vector<std::array<double, 2>> g,
               std::vector<Function> functions)
      : functions_(std::move(functions)) {
    const auto bounds = [](const auto& pairs, VectorXd& lower, VectorXd& upper) {
      lower.resize(static_cast<Index>(pairs.size()));
      upper = lower;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        lower(static_cast<Index>(i)) = pairs[i][0];
        upper(static_cast<Index>(i)) = pairs[i][1];
      }
    };
    bounds(x, x_lower, x_upper);
    bounds(g, g_lower, g_upper);
    for (int r = 0; r < constraints(); ++r) {
      for (int i = 0; i < variables(); ++i) jacobian_pattern.push_back({r, i});
    }
    for (int i = 0; i < variables(); ++i) {
      for (int j = 0; j <= i; ++j) hessian_pattern.push_back({i, j});
    }
  }

  double objective(const In& x) const override { return value(0, x).v; }
  void gradient(const In& x, Out out) const override {
    const Scalar f = value(0, x);
    for (Index i = 0; i < variables(); ++i) out(i) = f.g[static_cast<std::size_t>(i)];
  }
  void constraint_values(const In& x, Out out) const override {
    for (Index r = 0; r < constraints(); ++r) out(r) = value(r + 1, x).v;
  }
  void jacobian(const In& x, Out out) const override {
    Index e = 0;
    for (Index r = 0; r < constraints(); ++r) {
      const Scalar g = value(r + 1, x);
      for (Index i = 0; i < variables(); ++i) out(e++) = g.g[static_cast<std::size_t>(i)];
    }
  }
  void hessian(const In& x, double cost_factor, const In& multipliers, Out out) const override {
    out.setZero();
    for (Index r = 0; r <= constraints(); ++r) {
      const Scalar g = value(r, x);
      const double weight = r == 0 ? cost_factor : multipliers(r - 1);
      Index e = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(variables()); ++i) {
        for (std::size_t j = 0; j <= i; ++j) out(e++) += weight * g.second(i, j);
      }
    }
  }

 private:
  Scalar value(Index function, const In& x) const {
    std::array<Scalar, kMost> inputs;
    for (int i = 0; i < variables(); ++i) inputs[static_cast<std::size_t>(i)] = Scalar::input(x(i), i);
    return functions_[static_cast<std::size_t>(function)](inputs);
  }
  std::vector<Function> functions_;
};

Iterate from(std::vector<double> x) {
  return {Eigen::Map<VectorXd>(x.data(), static_cast<Index>(x.size())), {}, {}, {}};
}

Scalar squared(const Scalar& a) { return a * a; }
Scalar fourth(const Scalar& a) { return squared(squared(a)); }

// W. Hock & K. Schittkowski, Test Examples for Nonlinear Programming Codes, Springer 1981: problems by their number,
// with the optimum that is given there.
struct Example {
  int number;
  SmallProblem problem;
  std::vector<double> start;
  double optimum;
};

void PrintTo(const Example& example, std::ostream* out) { *out << "HS" << example.number; }

std::vector<Example> examples() {
  using X = std::array<Scalar, kMost>;
  const std::array<double, 2> anywhere{-kInfinity, kInfinity}, zero{0, 0}, positive{0, kInfinity};
  std::vector<Example> all;
  all.push_back({6,
                 SmallProblem({anywhere, anywhere}, {zero},
                              {[](const X& x) { return squared(1.0 - x[0]); },
                               [](const X& x) { return 10.0 * (x[1] - squared(x[0])); }}),
                 {-1.2, 1},
                 0});
  all.push_back({21,
                 SmallProblem({{2, 50}, {-50, 50}}, {{10, kInfinity}},
                              {[](const X& x) { return 0.01 * squared(x[0]) + squared(x[1]) - 100.0; },
                               [](const X& x) { return 10.0 * x[0] - x[1]; }}),
                 {-1, -1},
                 -99.96});
  all.push_back({35,
                 SmallProblem({positive, positive, positive}, {{-kInfinity, 3}},
                              {[](const X& x) {
                                 return 9.0 - 8.0 * x[0] - 6.0 * x[1] - 4.0 * x[2] + 2.0 * squared(x[0]) +
                                        2.0 * squared(x[1]) + squared(x[2]) + 2.0 * x[0] * x[1] + 2.0 * x[0] * x[2];
                               },
                               [](const X& x) { return x[0] + x[1] + 2.0 * x[2]; }}),
                 {0.5, 0.5, 0.5},
                 1.0 / 9});
  all.push_back({43,
                 SmallProblem({anywhere, anywhere, anywhere, anywhere}, {positive, positive, positive},
                              {[](const X& x) {
                                 return squared(x[0]) + squared(x[1]) + 2.0 * squared(x[2]) + squared(x[3]) -
                                        5.0 * x[0] - 5.0 * x[1] - 21.0 * x[2] + 7.0 * x[3];
                               },
                               [](const X& x) {
                                 return 8.0 - squared(x[0]) - squared(x[1]) - squared(x[2]) - squared(x[3]) - x[0] +
                                        x[1] - x[2] + x[3];
                               },
                               [](const X& x) {
                                 return 10.0 - squared(x[0]) - 2.0 * squared(x[1]) - squared(x[2]) -
                                        2.0 * squared(x[3]) + x[0] + x[3];
                               },
                               [](const X& x) {
                                 return 5.0 - 2.0 * squared(x[0]) - squared(x[1]) - squared(x[2]) - 2.0 * x[0] + x[1] +
                                        x[3];
                               }}),
                 {0, 0, 0, 0},
                 -44});
  all.push_back(
      {71,
       SmallProblem({{1, 5}, {1, 5}, {1, 5}, {1, 5}}, {{25, kInfinity}, {40, 40}},
                    {[](const X& x) { return x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]; },
                     [](const X& x) { return x[0] * x[1] * x[2] * x[3]; },
                     [](const X& x) { return squared(x[0]) + squared(x[1]) + squared(x[2]) + squared(x[3]); }}),
       {1, 5, 5, 1},
       17.0140173});
  all.push_back(
      {100,
       SmallProblem({anywhere, anywhere, anywhere, anywhere, anywhere, anywhere, anywhere},
                    {positive, positive, positive, positive},
                    {[](const X& x) {
                       return squared(x[0] - 10.0) + 5.0 * squared(x[1] - 12.0) + fourth(x[2]) +
                              3.0 * squared(x[3] - 11.0) + 10.0 * squared(x[4]) * fourth(x[4]) + 7.0 * squared(x[5]) +
                              fourth(x[6]) - 4.0 * x[5] * x[6] - 10.0 * x[5] - 8.0 * x[6];
                     },
                     [](const X& x) {
                       return 127.0 - 2.0 * squared(x[0]) - 3.0 * fourth(x[1]) - x[2] - 4.0 * squared(x[3]) -
                              5.0 * x[4];
                     },
                     [](const X& x) { return 282.0 - 7.0 * x[0] - 3.0 * x[1] - 10.0 * squared(x[2]) - x[3] + x[4]; },
                     [](const X& x) { return 196.0 - 23.0 * x[0] - squared(x[1]) - 6.0 * squared(x[5]) + 8.0 * x[6]; },
                     [](const X& x) {
                       return -4.0 * squared(x[0]) - squared(x[1]) + 3.0 * x[0] * x[1] - 2.0 * squared(x[2]) -
                              5.0 * x[5] + 11.0 * x[6];
                     }}),
       {1, 2, 0, 4, 0, 1, 1},
       680.6300573});
  return all;
}

class HockSchittkowski : public testing::TestWithParam<Example> {};

TEST_P(HockSchittkowski, HasThePublishedOptimum) {
  SolveOptions options;
  options.tolerance = 1e-9;
  const SolveReport report = solve_by_interior_point(GetParam().problem, from(GetParam().start), options);
  EXPECT_EQ(report.status, SolveStatus::kOptimal);
  // A unit of the last digit that is given; what the barrier leaves, mu times the bounds, is 1e-9.
  EXPECT_NEAR(report.objective, GetParam().optimum, 1e-7);
  EXPECT_LE(report.violation, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, HockSchittkowski, testing::ValuesIn(examples()),
                         [](const auto& instance) { return "Number" + std::to_string(instance.param.number); });

// Between its minima at +-1 the function is concave: a step of Newton's method alone leads to the maximum.
TEST(InteriorPoint, FindsAMinimumWhereTheHessianIsIndefinite) {
  const SmallProblem problem({{-5, 5}}, {}, {[](const auto& x) { return squared(squared(x[0]) - 1.0); }});
  const SolveReport report = solve_by_interior_point(problem, from({0.1}), SolveOptions{});
  EXPECT_EQ(report.status, SolveStatus::kOptimal);
  EXPECT_NEAR(std::abs(report.iterate.x(0)), 1, 1e-6);
}

// ---- collocation problems, against Ipopt and by the definition of a KKT point ----

SolveOptions with_barrier(double initial, double final) {
  SolveOptions options;
  options.barrier_strategy = BarrierStrategy::kMonotone;
  options.initial_barrier = initial;
  options.final_barrier = final;
  return options;
}

double largest(const VectorXd& v) { return v.lpNorm<Eigen::Infinity>(); }

// With the same algorithm and the same parameters the iterates are the same but for rounding; where a shift of the
// Hessian is carried over they part, and meet again at the optimum as far as the tolerance determines it.
TEST(InteriorPoint, ComesToIpoptsOptimum) {
  for (const PublishedProblem& problem : published_problems()) {
    SCOPED_TRACE(problem.name);
    const Posed posed = problem.pose(hermite_simpson(), 30);
    SolveOptions options = with_barrier(0.1, 1e-10);
    options.tolerance = 1e-9;
    const SolveReport ours = solve_by_interior_point(*posed.nlp, posed.start, options);
    const SolveReport theirs = solve_by_ipopt(*posed.nlp, posed.start, options);
    ASSERT_TRUE(ours.solved());
    ASSERT_TRUE(theirs.solved());
    EXPECT_NEAR(ours.objective, theirs.objective, 1e-7 * std::max(1.0, std::abs(theirs.objective)));
    EXPECT_LT(largest(ours.iterate.lambda - theirs.iterate.lambda),
              1e-3 * std::max(1.0, largest(theirs.iterate.lambda)));
  }
}

// The residuals from the problem's own functions, without anything of the method.
void expect_kkt_point(const Nlp& nlp, const Iterate& at, double tolerance) {
  VectorXd dual(nlp.variables()), g(nlp.constraints()), jacobian(static_cast<Index>(nlp.jacobian_pattern.size()));
  nlp.gradient(at.x, dual);
  nlp.jacobian(at.x, jacobian);
  nlp.constraint_values(at.x, g);
  for (std::size_t e = 0; e < nlp.jacobian_pattern.size(); ++e) {
    const auto [row, col] = nlp.jacobian_pattern[e];
    dual(col) += at.lambda(row) * jacobian(static_cast<Index>(e));
  }
  dual += at.z_upper - at.z_lower;
  // A multiplier is positive, and presses against its bound alone.
  const auto complementary = [&](double multiplier, double room) {
    const double product = std::isfinite(room) ? std::max(multiplier, 0.0) * room : 0;
    EXPECT_NEAR(product, 0, tolerance);
  };
  for (Index i = 0; i < nlp.variables(); ++i) {
    if (nlp.x_lower(i) == nlp.x_upper(i)) {
      EXPECT_EQ(at.x(i), nlp.x_lower(i));
      continue;
    }
    EXPECT_NEAR(dual(i), 0, tolerance);
    EXPECT_GT(at.x(i), nlp.x_lower(i));
    EXPECT_LT(at.x(i), nlp.x_upper(i));
    EXPECT_GE(std::min(at.z_lower(i), at.z_upper(i)), 0);
    complementary(at.z_lower(i), at.x(i) - nlp.x_lower(i));
    complementary(at.z_upper(i), nlp.x_upper(i) - at.x(i));
  }
  for (Index i = 0; i < nlp.constraints(); ++i) {
    EXPECT_GE(g(i), nlp.g_lower(i) - 1e-9);
    EXPECT_LE(g(i), nlp.g_upper(i) + 1e-9);
    complementary(-at.lambda(i), g(i) - nlp.g_lower(i));
    complementary(at.lambda(i), nlp.g_upper(i) - g(i));
  }
}

TEST(InteriorPoint, EndsAtAKktPoint) {
  SolveOptions options;
  options.tolerance = 1e-8;
  for (const bool as_row : {false, true}) {
    const Plant nlp = bryson_denham(hermite_simpson(), 24, 0.1, as_row);
    const SolveReport report = solve_by_interior_point(nlp, zeros(nlp, 1), options);
    ASSERT_EQ(report.status, SolveStatus::kOptimal);
    EXPECT_GT(largest(as_row ? report.iterate.lambda : report.iterate.z_upper), 0.1);  // the bound is active
    expect_kkt_point(nlp, report.iterate, 1e-8);
  }
}

TEST(InteriorPoint, RecognisesASolutionAtOnce) {
  const Plant nlp = bryson_denham(hermite_simpson(), 24, 0.1, true);
  const SolveReport cold = solve_by_interior_point(nlp, zeros(nlp, 1), with_barrier(0.1, 1e-7));
  ASSERT_TRUE(cold.solved());
  EXPECT_GT(cold.iterations, 5);
  SolveOptions options = with_barrier(1e-7, 1e-7);
  options.beginning = Beginning::kMultipliers;
  const SolveReport warm = solve_by_interior_point(nlp, cold.iterate, options);
  EXPECT_EQ(warm.status, SolveStatus::kOptimal);
  EXPECT_LE(warm.iterations, 1);  // measured: 0
}

// With linear dynamics and a quadratic cost the quadratic program is the problem itself, so that nothing is left to do
// where it leads, but for the small weight on changes. The state bound is active on another part of the motion there.
TEST(InteriorPoint, BeginsAtTheSolutionOfTheQuadraticProgram) {
  const Plant first = bryson_denham(hermite_simpson(), 24, 0.1, true),
              neighbour = bryson_denham(hermite_simpson(), 24, 0.08, true);
  const SolveReport cold = solve_by_interior_point(first, zeros(first, 1), with_barrier(0.1, 1e-7));
  ASSERT_TRUE(cold.solved());
  SolveOptions options = with_barrier(1e-7, 1e-7);
  options.beginning = Beginning::kMultipliers;
  const SolveReport step_by_step = solve_by_interior_point(neighbour, cold.iterate, options);
  options.beginning = Beginning::kQuadraticProgram;
  const SolveReport at_once = solve_by_interior_point(neighbour, cold.iterate, options);
  ASSERT_EQ(step_by_step.status, SolveStatus::kOptimal);
  ASSERT_EQ(at_once.status, SolveStatus::kOptimal);
  EXPECT_LE(at_once.iterations, 3);                                    // measured: 1
  EXPECT_GT(step_by_step.iterations, 5);                               // measured: 19
  EXPECT_GT(at_once.work, work_of(neighbour, at_once.iterations, 0));  // its factorisations count
  EXPECT_NEAR(at_once.objective, step_by_step.objective, 1e-6 * step_by_step.objective);
  expect_kkt_point(neighbour, at_once.iterate, 1e-6);
}

void expect_the_same_bits(const SolveReport& a, const SolveReport& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.work, b.work);
  EXPECT_EQ(a.iterate.x, b.iterate.x);
  EXPECT_EQ(a.iterate.lambda, b.iterate.lambda);
  EXPECT_EQ(a.iterate.z_lower, b.iterate.z_lower);
  EXPECT_EQ(a.iterate.z_upper, b.iterate.z_upper);
}

TEST(InteriorPoint, GivesTheSameBitsTwice) {
  const Plant nlp = fastest(hermite_simpson(), 20, 0.1, 10), shorter = fastest(hermite_simpson(), 20, 0.1, 2.1);
  const SolveReport cold = solve_by_interior_point(nlp, zeros(nlp, 3), SolveOptions{});
  ASSERT_TRUE(cold.solved());
  expect_the_same_bits(cold, solve_by_interior_point(nlp, zeros(nlp, 3), SolveOptions{}));
  SolveOptions options = with_barrier(1e-7, 1e-7);
  options.beginning = Beginning::kQuadraticProgram;
  const SolveReport warm = solve_by_interior_point(shorter, cold.iterate, options);
  EXPECT_TRUE(warm.solved());
  expect_the_same_bits(warm, solve_by_interior_point(shorter, cold.iterate, options));
}

// ---- the quadratic program at a point ----

std::optional<PrimalDual> quadratic_solution(const Nlp& nlp, const VectorXd& x) {
  SlackForm form(nlp, x);
  KktSystem system(form, one_after_the_other);
  const Index n = form.variables();
  const PrimalDual at{form.from_x(x), VectorXd::Zero(form.constraints()), VectorXd::Zero(n), VectorXd::Zero(n)};
  VectorXd gradient, c;
  form.differentiate(at.v, gradient);
  form.constraint_values(at.v, c);
  form.set_hessian(at.v, at.y);
  std::optional<PrimalDual> solution =
      solve_quadratic_program(form, system, at, gradient, c, 1e-9, [] { return true; });
  if (solution) solution->v = form.to_x(solution->v);
  return solution;
}

// Example 35 of Hock & Schittkowski is quadratic: its optimum is (4/3, 7/9, 4/9) with 2/9 as the multiplier of its row.
// The weight of 1e-6 on changes moves that by as much, relative to the curvatures of 1 to 5.
TEST(QuadraticProgram, HasThePublishedOptimum) {
  const SmallProblem problem = examples()[2].problem;
  for (const VectorXd& x : {VectorXd(Eigen::Vector3d(0.5, 0.5, 0.5)), VectorXd(Eigen::Vector3d(0, 0, 1.5))}) {
    const std::optional<PrimalDual> solution = quadratic_solution(problem, x);
    ASSERT_TRUE(solution);
    EXPECT_LT(largest(solution->v - Eigen::Vector3d(4.0 / 3, 7.0 / 9, 4.0 / 9)), 1e-5);
    EXPECT_NEAR(solution->y(0), 2.0 / 9, 1e-5);
    EXPECT_LT(largest(solution->z_lower), 1e-5);
  }
}

TEST(QuadraticProgram, HasNoSolutionWhereRowsAndBoundsContradictEachOther) {
  const std::array<double, 2> unit{0, 1};
  const SmallProblem problem(
      {unit, unit}, {{2.5, 2.5}},
      {[](const auto& x) { return squared(x[0]) + squared(x[1]); }, [](const auto& x) { return x[0] + x[1]; }});
  EXPECT_FALSE(quadratic_solution(problem, Eigen::Vector2d(0.5, 0.5)));
}

// The row x^2 = 4 has a solution at 2. Seen from 0.2 it wants 10.1, beyond the bound, and seen from 0.05 even a quarter
// of the way to it does.
TEST(QuadraticProgram, WithoutASolutionIsApproachedInParts) {
  const SmallProblem problem({{0, 3}}, {{4, 4}},
                             {[](const auto& x) { return x[0]; }, [](const auto& x) { return squared(x[0]); }});
  const auto from = [](double x) -> Iterate {
    return {VectorXd::Constant(1, x), VectorXd::Zero(1), VectorXd::Ones(1), VectorXd::Zero(1)};
  };
  SolveOptions without;
  without.beginning = Beginning::kMultipliers;
  SolveOptions with = without;
  with.beginning = Beginning::kQuadraticProgram;
  for (const double x : {0.2, 0.05}) {
    ASSERT_FALSE(quadratic_solution(problem, from(x).x));
    const SolveReport one = solve_by_interior_point(problem, from(x), without),
                      other = solve_by_interior_point(problem, from(x), with);
    EXPECT_NEAR(one.iterate.x(0), 2, 1e-6);
    EXPECT_NEAR(other.iterate.x(0), 2, 1e-6);
    if (x == 0.2) {
      EXPECT_LT(other.iterations, one.iterations);
    } else {  // it is left to the method where it is
      EXPECT_EQ(other.iterations, one.iterations);
    }
  }
}

// The second row says what the first one does, so that the KKT matrix is singular; and there are no bounds at all.
TEST(QuadraticProgram, IsSolvedWithDependentRowsAndWithoutBounds) {
  const std::array<double, 2> anywhere{-kInfinity, kInfinity};
  const auto sum = [](const auto& x) { return x[0] + x[1]; };
  const SmallProblem problem({anywhere, anywhere}, {{1, 1}, {1, 1}},
                             {[](const auto& x) { return squared(x[0]) + squared(x[1]); }, sum, sum});
  const std::optional<PrimalDual> solution = quadratic_solution(problem, Eigen::Vector2d(0, 3));
  ASSERT_TRUE(solution);
  EXPECT_LT(largest(solution->v - Eigen::Vector2d(0.5, 0.5)), 1e-5);
}

// The quadratic program of sqrt(x) + x^2 / 8 at 1 leads to a negative x.
TEST(QuadraticProgram, IsNotFollowedToWhereTheProblemIsNotDefined) {
  const SmallProblem problem({{-5, 5}}, {}, {[](const auto& x) { return sqrt(x[0]) + 0.125 * squared(x[0] + 1.0); }});
  const Iterate start{VectorXd::Ones(1), {}, VectorXd::Zero(1), VectorXd::Zero(1)};
  ASSERT_TRUE(quadratic_solution(problem, start.x));
  ASSERT_LT(quadratic_solution(problem, start.x)->v(0), 0);
  SolveOptions options;
  options.max_iterations = 0;
  options.beginning = Beginning::kQuadraticProgram;
  const SolveReport report = solve_by_interior_point(problem, start, options);
  EXPECT_EQ(report.status, SolveStatus::kIterationLimit);
  EXPECT_EQ(report.iterate.x(0), 1);
}

// ---- how it ends otherwise ----

TEST(InteriorPoint, GivesUpOnTheInfeasibleAndLeavesItToIpopt) {
  const Plant nlp = fastest(hermite_simpson(), 10, 1, 1);  // half the time it takes
  SolveOptions options;
  const SolveReport ours = solve_by_interior_point(nlp, zeros(nlp, 1), options);
  EXPECT_EQ(ours.status, SolveStatus::kFailed);
  EXPECT_LT(ours.iterations, options.max_iterations);
  EXPECT_GT(ours.violation, 1e-3);
  options.optimiser = Optimiser::kInteriorPoint;
  const SolveReport both = solve(nlp, zeros(nlp, 1), options);
  EXPECT_EQ(both.status, SolveStatus::kInfeasible);
  EXPECT_TRUE(both.fell_back);
  EXPECT_GT(both.iterations, ours.iterations);
  EXPECT_GT(both.work, ours.work);
}

TEST(InteriorPoint, StopsWhenTheMonitorSaysSo) {
  const Plant nlp = fastest(hermite_simpson(), 10, 0.1, 10);
  SolveOptions options;
  options.optimiser = Optimiser::kInteriorPoint;
  std::vector<int> seen;
  options.monitor = [&seen](const IterationInfo& info) {
    seen.push_back(info.iteration);
    return info.iteration < 3;
  };
  const SolveReport report = solve(nlp, zeros(nlp, 3), options);
  EXPECT_EQ(report.status, SolveStatus::kStopped);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_EQ(seen, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_FALSE(report.fell_back);
}

TEST(InteriorPoint, StopsWithinTheQuadraticProgram) {
  const Plant first = bryson_denham(hermite_simpson(), 24, 0.1, true),
              neighbour = bryson_denham(hermite_simpson(), 24, 0.08, true);
  const SolveReport cold = solve_by_interior_point(first, zeros(first, 1), with_barrier(0.1, 1e-7));
  SolveOptions options = with_barrier(1e-7, 1e-7);
  options.beginning = Beginning::kQuadraticProgram;
  int left = 3;
  options.monitor = [&left](const IterationInfo&) { return --left > 0; };
  const SolveReport report = solve_by_interior_point(neighbour, cold.iterate, options);
  EXPECT_EQ(report.status, SolveStatus::kStopped);
  EXPECT_LT(report.cost.factorisations, 3);
}

TEST(InteriorPoint, ReportsTheIterationLimit) {
  const Plant nlp = fastest(hermite_simpson(), 10, 0.1, 10);
  SolveOptions options;
  options.max_iterations = 2;
  const SolveReport report = solve_by_interior_point(nlp, zeros(nlp, 3), options);
  EXPECT_EQ(report.status, SolveStatus::kIterationLimit);
  EXPECT_EQ(report.iterations, 2);
}

TEST(InteriorPoint, ReportsBreakdown) {
  const Plant nlp = fastest(hermite_simpson(), 10, 0.1, 10);
  Iterate start = zeros(nlp, 3);
  start.x(5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solve_by_interior_point(nlp, start, SolveOptions{}).status, SolveStatus::kFailed);
}

}  // namespace
}  // namespace fjr
