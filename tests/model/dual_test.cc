// Derivatives carried by Dual and Dual2 against closed forms and differences; Pattern against what they find.
#include "common/dual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/arbitrary.h"

namespace fjr {
namespace {

template <class D>
double hessian_entry(const D& d, std::size_t i, std::size_t j) {
  return d.second(i, j);
}

// ---- every elementary function, against its derivatives from a table ----

struct Elementary {
  const char* name;
  std::function<Dual2<1>(const Dual2<1>&)> second;
  std::function<Dual<1>(const Dual<1>&)> first;
  std::function<double(double)> f, f1, f2;
};

#define FJR_BOTH(expression) \
  [](const Dual2<1>& a) -> Dual2<1> { return expression; }, [](const Dual<1>& a) -> Dual<1> { return expression; }

const std::vector<Elementary>& elementary() {
  static const std::vector<Elementary> all{
      {"sin", FJR_BOTH(sin(a)), [](double x) { return std::sin(x); }, [](double x) { return std::cos(x); },
       [](double x) { return -std::sin(x); }},
      {"cos", FJR_BOTH(cos(a)), [](double x) { return std::cos(x); }, [](double x) { return -std::sin(x); },
       [](double x) { return -std::cos(x); }},
      {"tanh", FJR_BOTH(tanh(a)), [](double x) { return std::tanh(x); },
       [](double x) { return 1 / (std::cosh(x) * std::cosh(x)); },
       [](double x) { return -2 * std::sinh(x) / std::pow(std::cosh(x), 3); }},
      {"exp", FJR_BOTH(exp(a)), [](double x) { return std::exp(x); }, [](double x) { return std::exp(x); },
       [](double x) { return std::exp(x); }},
      {"sqrt", FJR_BOTH(sqrt(a)), [](double x) { return std::sqrt(x); }, [](double x) { return 0.5 / std::sqrt(x); },
       [](double x) { return -0.25 / std::pow(x, 1.5); }},
      {"inverse", FJR_BOTH(inverse(a)), [](double x) { return 1 / x; }, [](double x) { return -1 / (x * x); },
       [](double x) { return 2 / (x * x * x); }},
      {"constant over", FJR_BOTH(3.0 / a), [](double x) { return 3 / x; }, [](double x) { return -3 / (x * x); },
       [](double x) { return 6 / (x * x * x); }},
      {"square", FJR_BOTH(a * a), [](double x) { return x * x; }, [](double x) { return 2 * x; },
       [](double) { return 2.0; }},
      {"over constant", FJR_BOTH(a / 4.0), [](double x) { return x / 4; }, [](double) { return 0.25; },
       [](double) { return 0.0; }},
      {"times constant", FJR_BOTH(2.5 * a), [](double x) { return 2.5 * x; }, [](double) { return 2.5; },
       [](double) { return 0.0; }},
      {"constant times", FJR_BOTH(a * 2.5), [](double x) { return 2.5 * x; }, [](double) { return 2.5; },
       [](double) { return 0.0; }},
      {"negation", FJR_BOTH(-a), [](double x) { return -x; }, [](double) { return -1.0; }, [](double) { return 0.0; }},
      {"plus constant", FJR_BOTH(a + 3.0), [](double x) { return x + 3; }, [](double) { return 1.0; },
       [](double) { return 0.0; }},
      {"constant plus", FJR_BOTH(3.0 + a), [](double x) { return x + 3; }, [](double) { return 1.0; },
       [](double) { return 0.0; }},
      {"minus constant", FJR_BOTH(a - 3.0), [](double x) { return x - 3; }, [](double) { return 1.0; },
       [](double) { return 0.0; }},
      {"constant minus", FJR_BOTH(3.0 - a), [](double x) { return 3 - x; }, [](double) { return -1.0; },
       [](double) { return 0.0; }},
  };
  return all;
}

#undef FJR_BOTH

RC_GTEST_PROP(Dual, ElementaryFunctionsHaveTheirDerivatives, ()) {
  const double x = between(0.1, 3);
  for (const Elementary& e : elementary()) {
    const auto second = e.second(Dual2<1>::input(x, 0));
    const auto first = e.first(Dual<1>::input(x, 0));
    // A few roundings of values up to 2,000 (the second derivative of 1/x at 0.1), relative to their size.
    const auto close = [](double a, double b) { return std::abs(a - b) <= 2e-14 * (1 + std::abs(b)); };
    if (!(close(second.v, e.f(x)) && close(second.g[0], e.f1(x)) && close(second.second(0, 0), e.f2(x)) &&
          close(first.v, e.f(x)) && close(first.g[0], e.f1(x)))) {
      RC_FAIL(std::string(e.name));
    }
  }
}

// ---- compositions of three inputs, for every scalar ----

constexpr int kInputs = 3;

struct Rational {
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    return x * y / (1.0 + z * z) - y / 3.0 + 2.0 * z / x;
  }
};
struct Transcendental {
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    using std::cos;
    using std::exp;
    using std::sin;
    using std::sqrt;
    using std::tanh;
    return sin(x * y) + exp(-x) * cos(z) + tanh(y - z) * sqrt(x + 2.0) - 0.5 * y;
  }
};
struct Compound {
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    T r = x;
    r += y * z;
    r *= x;
    r -= 3.0 * z;
    return -r;
  }
};

template <class F>
class Composition : public testing::Test {};
using Compositions = testing::Types<Rational, Transcendental, Compound>;
TYPED_TEST_SUITE(Composition, Compositions);

template <class D>
D at(const auto& f, const std::array<double, kInputs>& p) {
  return f(D::input(p[0], 0), D::input(p[1], 1), D::input(p[2], 2));
}

TYPED_TEST(Composition, DerivativesMatchCentralDifferences) {
  const TypeParam f;
  const double h = std::cbrt(2.2e-16);
  // Truncation: h^2/6 = 6e-12 times fourth derivatives up to 5e3 (1/x at 0.4). Rounding: 1e-16/h of values below 100.
  constexpr double kTolerance = 1e-7;
  for (double x = 0.4; x < 2; x += 0.37) {
    for (double y = -1.1; y < 2; y += 0.61) {
      const std::array<double, kInputs> p{x, y, 0.3 + 0.7 * x * y};
      const auto second = at<Dual2<kInputs>>(f, p);
      const auto first = at<Dual<kInputs>>(f, p);
      EXPECT_DOUBLE_EQ(second.v, f(p[0], p[1], p[2]));
      EXPECT_DOUBLE_EQ(first.v, second.v);
      for (std::size_t i = 0; i < kInputs; ++i) {
        auto after = p, before = p;
        after[i] += h;
        before[i] -= h;
        const double slope = (f(after[0], after[1], after[2]) - f(before[0], before[1], before[2])) / (2 * h);
        EXPECT_NEAR(second.g[i], slope, kTolerance);
        EXPECT_DOUBLE_EQ(first.g[i], second.g[i]);
        const auto gradient_after = at<Dual<kInputs>>(f, after), gradient_before = at<Dual<kInputs>>(f, before);
        for (std::size_t j = 0; j < kInputs; ++j) {
          const double curvature = (gradient_after.g[j] - gradient_before.g[j]) / (2 * h);
          EXPECT_NEAR(hessian_entry(second, i, j), curvature, kTolerance) << i << ", " << j;
        }
      }
    }
  }
}

TYPED_TEST(Composition, PatternCoversEveryNonZero) {
  const TypeParam f;
  const auto pattern = at<Pattern<kInputs>>(f, {1, 1, 1});
  const auto values = at<Dual2<kInputs>>(f, {0.7, -1.3, 0.9});
  for (int i = 0; i < kInputs; ++i) {
    const auto row = static_cast<std::size_t>(i);
    if (values.g[row] != 0) {
      EXPECT_TRUE(pattern.depends_on(i));
    }
    for (int j = 0; j < kInputs; ++j) {
      if (hessian_entry(values, row, static_cast<std::size_t>(j)) != 0) {
        EXPECT_TRUE(pattern.curved_in(i, j)) << i << ", " << j;
      }
      EXPECT_EQ(pattern.curved_in(i, j), pattern.curved_in(j, i));
    }
  }
}

// ---- the pattern of the dynamics themselves ----

RC_GTEST_PROP(Pattern, CoversTheDynamics, ()) {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  const State<double> x = any_state();
  const Joints<double> u = pair_between(-12, 12);
  const auto evaluate = [&]<class D>(D) {
    State<D> state;
    for (int i = 0; i < kStates; ++i) state[i] = D::input(x[i], i);
    return compensated_dynamics(p, state, {D::input(u[0], 8), D::input(u[1], 9)});
  };
  const auto pattern = evaluate(Pattern<10>{});
  const auto values = evaluate(Dual2<10>{});
  for (int c = 0; c < kStates; ++c) {
    for (int i = 0; i < 10; ++i) {
      const auto row = static_cast<std::size_t>(i);
      RC_ASSERT(values[c].g[row] == 0 || pattern[c].depends_on(i));
      for (int j = 0; j < 10; ++j) {
        RC_ASSERT(hessian_entry(values[c], row, static_cast<std::size_t>(j)) == 0 || pattern[c].curved_in(i, j));
      }
    }
  }
}

TEST(Pattern, IsTightForLinearCombinations) {
  using P = Pattern<4>;
  const P a = P::input(1, 0), b = P::input(1, 1), c = P::input(1, 2);
  const P r = 2.0 * a - b / 3.0 + (1.0 - c * 0.5) + 4.0;
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(r.depends_on(i), i != 3);
    for (int j = 0; j < 4; ++j) EXPECT_FALSE(r.curved_in(i, j));
  }
}

TEST(Pattern, ProductsAreCurvedOnlyInTheirPairs) {
  using P = Pattern<3>;
  const P r = P::input(1, 0) * P::input(1, 1) + P::input(1, 2);
  EXPECT_TRUE(r.curved_in(0, 1));
  EXPECT_TRUE(r.curved_in(1, 0));
  EXPECT_FALSE(r.curved_in(0, 0));
  EXPECT_FALSE(r.curved_in(1, 1));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(r.curved_in(2, i));
}

TEST(Pattern, FunctionsAreCurvedInEveryPairOfTheirInputs) {
  using P = Pattern<3>;
  const P r = sin(P::input(1, 0) + P::input(1, 2));
  EXPECT_TRUE(r.curved_in(0, 0));
  EXPECT_TRUE(r.curved_in(0, 2));
  EXPECT_TRUE(r.curved_in(2, 2));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(r.curved_in(1, i));
}

// The motors' rows are linear in everything: collocation counts on their having no Hessian.
TEST(Pattern, MotorRowsOfTheDynamicsHaveNoCurvature) {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  State<Pattern<10>> x;
  for (int i = 0; i < kStates; ++i) x[i] = Pattern<10>::input(1, i);
  const auto f = compensated_dynamics(p, x, {Pattern<10>::input(1, 8), Pattern<10>::input(1, 9)});
  for (std::size_t j = 0; j < kJoints; ++j) {
    for (const auto& row : f.dtheta[j].h) EXPECT_EQ(row, 0u);
    for (const auto& row : f.theta[j].h) EXPECT_EQ(row, 0u);
    for (const auto& row : f.q[j].h) EXPECT_EQ(row, 0u);
  }
}

}  // namespace
}  // namespace fjr
