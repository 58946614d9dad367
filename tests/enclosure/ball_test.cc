// Balls against 200-bit arithmetic (MPFR), which is independent of the library's elementary functions.
#include "common/enclosure/ball.h"

#include <gtest/gtest.h>
#include <mpfr.h>

#include <array>
#include <cfenv>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>

namespace enclosure {
namespace {

constexpr int kBits = 200;

class Exact {
 public:
  explicit Exact(double value = 0) {
    mpfr_init2(value_, kBits);
    mpfr_set_d(value_, value, MPFR_RNDN);
  }
  Exact(const Exact& other) : Exact() { mpfr_set(value_, other.value_, MPFR_RNDN); }
  Exact& operator=(const Exact& other) {
    mpfr_set(value_, other.value_, MPFR_RNDN);
    return *this;
  }
  ~Exact() { mpfr_clear(value_); }
  mpfr_ptr get() { return value_; }
  mpfr_srcptr get() const { return value_; }

 private:
  mpfr_t value_;
};

// |x - mid| <= rad, to 200 bits.
bool holds(const Ball& ball, const Exact& x) {
  Exact off;
  mpfr_sub_d(off.get(), x.get(), ball.mid, MPFR_RNDN);
  mpfr_abs(off.get(), off.get(), MPFR_RNDN);
  return mpfr_cmp_d(off.get(), ball.rad) <= 0;
}

using Unary = int (*)(mpfr_t, const mpfr_t, mpfr_rnd_t);
using Binary = int (*)(mpfr_t, const mpfr_t, const mpfr_t, mpfr_rnd_t);

Exact exactly(Unary f, double x) {
  Exact y(x);
  f(y.get(), y.get(), MPFR_RNDN);
  return y;
}
int exact_sech2(mpfr_t y, const mpfr_t x, mpfr_rnd_t round) {
  mpfr_sech(y, x, round);
  return mpfr_sqr(y, y, round);
}

// Doubles of all sizes up to 2^largest.
class Numbers {
 public:
  double any(int largest = 6) {
    const int exponent = std::uniform_int_distribution<int>(-40, largest)(random_);
    return std::ldexp(std::uniform_real_distribution<double>(-1, 1)(random_), exponent);
  }
  Ball ball(int largest = 6) {
    const int relative = std::uniform_int_distribution<int>(-60, 1)(random_);
    const double middle = any(largest);
    return {middle, std::ldexp(std::abs(middle), relative)};
  }
  // Of the ball, its ends among them. A double may lie just outside of it, then it is taken back.
  double in(const Ball& b) {
    const double fraction = std::uniform_int_distribution<int>(0, 3)(random_) == 0
                                ? std::copysign(1.0, any())
                                : std::uniform_real_distribution<double>(-1, 1)(random_);
    const double x = b.mid + fraction * b.rad;
    return holds(b, Exact(x)) ? x : b.mid;
  }

 private:
  std::mt19937_64 random_{1};
};

TEST(Ball, HoldsTheExactResultsOfAllItsElements) {
  Numbers numbers;
  const std::array<std::pair<Ball (*)(const Ball&, const Ball&), Binary>, 4> operations{
      {{[](const Ball& a, const Ball& b) { return a + b; }, mpfr_add},
       {[](const Ball& a, const Ball& b) { return a - b; }, mpfr_sub},
       {[](const Ball& a, const Ball& b) { return a * b; }, mpfr_mul},
       {[](const Ball& a, const Ball& b) { return a / b; }, mpfr_div}}};
  for (int i = 0; i < 40'000; ++i) {
    const Ball a = numbers.ball(), b = numbers.ball();
    const double x = numbers.in(a), y = numbers.in(b);
    for (const auto& [ours, exact] : operations) {
      const Ball result = ours(a, b);
      if (!result.is_bounded()) continue;  // a division by a ball with zero in it
      Exact value(x);
      exact(value.get(), value.get(), Exact(y).get(), MPFR_RNDN);
      ASSERT_TRUE(holds(result, value)) << x << ' ' << y;
    }
  }
}

TEST(Ball, HoldsTheExactFunctionsOfAllItsElements) {
  Numbers numbers;
  const std::array<std::pair<Ball (*)(const Ball&), Unary>, 6> functions{
      {{sin, mpfr_sin}, {cos, mpfr_cos}, {tanh, mpfr_tanh}, {exp, mpfr_exp}, {square, mpfr_sqr}, {sech2, exact_sech2}}};
  for (int i = 0; i < 20'000; ++i) {
    const Ball a = numbers.ball();
    const double x = numbers.in(a);
    for (const auto& [ours, exact] : functions) ASSERT_TRUE(holds(ours(a), exactly(exact, x))) << x;
  }
}

// The assumption about the C library. Where balls use them: angles, and arguments of friction laws up to saturation.
TEST(Ball, ElementaryFunctionsOfTheLibraryAreAsGoodAsAssumed) {
  Numbers numbers;
  const std::array<std::pair<double (*)(double), Unary>, 4> functions{
      {{std::sin, mpfr_sin}, {std::cos, mpfr_cos}, {std::tanh, mpfr_tanh}, {std::exp, mpfr_exp}}};
  for (int i = 0; i < 100'000; ++i) {
    const double x = numbers.any(9);
    for (const auto& [ours, exact] : functions) {
      const double value = ours(x);
      ASSERT_TRUE(holds({value, kElementaryError * std::abs(value)}, exactly(exact, x))) << x;
    }
  }
}

TEST(Ball, ASumWithoutItsRoundingErrorWouldBeCaught) {
  Exact sum(0.1);
  mpfr_add_d(sum.get(), sum.get(), 0.2, MPFR_RNDN);
  EXPECT_TRUE(holds(Ball(0.1) + Ball(0.2), sum));
  EXPECT_FALSE(holds(Ball(0.1 + 0.2), sum));
}

TEST(Ball, SumsOfProductsHoldTheExactSum) {
  Numbers numbers;
  for (int i = 0; i < 6'000; ++i) {
    SumOfProducts sum;
    Exact exact;
    const auto any = [&] { return i % 2 == 0 ? numbers.ball() : Ball(numbers.any()); };  // with radius, and exact ones
    for (int k = 1; k <= 14; ++k) {
      const Ball a = any(), b = any();
      Exact term(numbers.in(a));
      mpfr_mul_d(term.get(), term.get(), numbers.in(b), MPFR_RNDN);
      mpfr_mul_d(term.get(), term.get(), k, MPFR_RNDN);
      mpfr_add(exact.get(), exact.get(), term.get(), MPFR_RNDN);
      sum.add(a, b, k);
    }
    mpfr_div_d(exact.get(), exact.get(), 7, MPFR_RNDN);
    ASSERT_TRUE(holds(sum.total(7), exact));
  }
}

TEST(Ball, WhatIsNotFiniteStaysUnbounded) {
  const double infinite = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const Ball& b : {Ball(infinite), Ball(nan), Ball(0, nan), Ball::unbounded(), Ball(1) / Ball(0, 1)}) {
    for (const Ball& r :
         {b, b + 1.0, 2.0 * b, b - b, square(b), exp(b), sin(b), tanh(b), sech2(b), Ball(1) / (b * 0.0)}) {
      EXPECT_FALSE(r.is_bounded());
      EXPECT_FALSE(Ball(0, 1).contains(r));
    }
  }
}

TEST(Ball, RoundingIsToNearestMeanwhileAndAsItWasAfterwards) {
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
  {
    const RoundingToNearest nearest;
    EXPECT_EQ(std::fegetround(), FE_TONEAREST);
  }
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  std::fesetround(FE_TONEAREST);
}

}  // namespace
}  // namespace enclosure
