// Enclosures against closed forms, sampled solutions, and what would have to fail.
#include "common/enclosure/flow.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace enclosure {
namespace {

// f(x, u) -> dx/dt
template <std::size_t N, class F>
Recording record(const F& f, std::size_t signals = 0) {
  Recording recording(N + signals);
  std::array<Active, N> x;
  for (std::size_t i = 0; i < N; ++i) x[i] = recording.input(i);
  std::vector<Active> u;
  for (std::size_t j = 0; j < signals; ++j) u.push_back(recording.input(N + j));
  for (const Active& rate : f(x, u)) recording.output(rate);
  return recording;
}

const auto ignore = [](const auto&) { return true; };

template <std::size_t N>
Balls<N> after(const Recording& f, const Balls<N>& start, double duration, const FlowOptions& options = {}) {
  Flow<N> flow(f, options);
  flow.start(start);
  EXPECT_TRUE(flow.run({}, duration, ignore));
  return flow.set().hull();
}

template <class T>
std::array<T, 2> oscillator(const std::array<T, 2>& x, const std::vector<T>&, double stiffness = 4) {
  return {x[1], -stiffness * x[0]};
}

template <class T>
std::array<T, 2> pendulum(const std::array<T, 2>& x, const std::vector<T>& = {}) {
  using std::sin;
  return {x[1], -sin(x[0])};
}

// Rounding of 1e-16 a step, a few hundred steps.
constexpr double kNarrow = 1e-12;
// Of closed forms and sampled solutions in long double.
constexpr double kReference = 1e-17;

void expect_narrow_around(const Ball& ball, long double exact, double narrow = kNarrow) {
  EXPECT_LE(std::abs(exact - ball.mid), ball.rad + kReference * std::abs(exact));
  EXPECT_LT(ball.rad, narrow);
}

TEST(Taylor, CoefficientsAreThoseOfTheFunctions) {
  Recording f(1);
  const Active t = f.input(0);
  for (const Active& y : {sin(t), cos(t), exp(t), tanh(t), 1.0 / (1.0 - t), t * t / (2.0 + t)}) f.output(y);
  Series s(f, 7);
  s.at(0, 1) = 1;
  Slopes<1> d(f, 7);
  d.at(0, 0).set(0, 1);
  for (std::size_t k = 0; k <= 7; ++k) {
    s.compute(k);
    d.compute(s, k);
  }
  const std::vector<std::vector<long double>> exact = {
      {0, 1, 0, -1 / 6.0L, 0, 1 / 120.0L, 0, -1 / 5040.0L},
      {1, 0, -1 / 2.0L, 0, 1 / 24.0L, 0, -1 / 720.0L, 0},
      {1, 1, 1 / 2.0L, 1 / 6.0L, 1 / 24.0L, 1 / 120.0L, 1 / 720.0L, 1 / 5040.0L},
      {0, 1, 0, -1 / 3.0L, 0, 2 / 15.0L, 0, -17 / 315.0L},
      {1, 1, 1, 1, 1, 1, 1, 1},
      {0, 0, 1 / 2.0L, -1 / 4.0L, 1 / 8.0L, -1 / 16.0L, 1 / 32.0L, -1 / 64.0L}};
  for (std::size_t i = 0; i < exact.size(); ++i) {
    for (std::size_t k = 0; k <= 7; ++k) {
      expect_narrow_around(s.output(i, k), exact[i][k], 1e-14);
      // The derivative by the input's constant is that of the series: d f_k = (k + 1) f_(k+1).
      if (k < 7) {
        const auto slope = d.at(f.outputs()[i], k)[0];
        expect_narrow_around(slope, static_cast<long double>(k + 1) * exact[i][k + 1], kNarrow);
      }
    }
  }
}

// tanh' = sech^2 is tiny there, and so is the width of all coefficients: steps across a saturated law can be long.
TEST(Taylor, OfASaturatedTanhNothingIsLeft) {
  Recording f(1);
  f.output(tanh(1e4 * f.input(0)));
  Series s(f, 10);
  s.at(0, 0) = 0.01;
  s.at(0, 1) = 1;
  for (std::size_t k = 0; k <= 10; ++k) {
    s.compute(k);
    EXPECT_LT((s.output(0, k) - (k == 0 ? 1.0 : 0.0)).magnitude(), k == 0 ? 1e-15 : 1e-40);
  }
}

TEST(Flow, HarmonicOscillator) {
  const Recording f = record<2>([](const auto& x, const auto& u) { return oscillator(x, u); });
  const Balls<2> x = after<2>(f, {1.0, 0.0}, 10);
  expect_narrow_around(x[0], std::cos(20.0L));
  expect_narrow_around(x[1], -2 * std::sin(20.0L));
}

TEST(Flow, Exponential) {
  const Recording f = record<1>([](const auto& x, const auto&) { return x; });
  const Balls<1> x = after<1>(f, {1.0}, 5);
  expect_narrow_around(x[0], std::exp(5.0L), std::exp(5.0) * kNarrow);
}

TEST(Flow, Logistic) {
  const Recording f = record<1>([](const auto& x, const auto&) { return std::array{x[0] * (1.0 - x[0])}; });
  const Balls<1> x = after<1>(f, {0.25}, 3);
  expect_narrow_around(x[0], 1 / (1 + 3 * std::exp(-3.0L)));
}

TEST(Flow, PendulumKeepsItsEnergy) {
  const Recording f = record<2>([](const auto& x, const auto& u) { return pendulum(x, u); });
  const Balls<2> x = after<2>(f, {2.0, 0.0}, 20);
  expect_narrow_around(0.5 * square(x[1]) - cos(x[0]), -std::cos(2.0L), 1e-11);
}

TEST(Flow, SignalsArePolynomialsOfTheTimeSinceTheRunBegan) {
  const Recording f = record<1>([](const auto&, const auto& u) { return std::array{u[0]}; }, 1);
  Flow<1> flow(f);
  flow.start({1.0});
  const std::vector<Polynomial> u{{1.0, 2.0, 3.0, 4.0}};
  ASSERT_TRUE(flow.run(u, 2.0, ignore));
  ASSERT_TRUE(flow.run(u, 1.0, ignore));
  expect_narrow_around(flow.set().hull()[0], 1 + 30 + 4);
}

// In one step from a point, all of the width is that of the remainder. Over a box as wide as the way, coefficient p
// times h^p is as wide as h^(p+1).
TEST(Flow, WidthOfAStepFallsWithItsOrder) {
  const Recording f = record<2>([](const auto& x, const auto& u) { return pendulum(x, u); });
  for (const std::size_t order : {4U, 6U, 8U}) {
    FlowOptions options;
    options.order = options.slope_order = order;
    options.remainder = 1;
    const auto width = [&](double h) { return after<2>(f, {2.0, 0.7}, h, options)[0].rad; };
    const double h = 0.4;
    EXPECT_NEAR(std::log2(width(h) / width(h / 2)), static_cast<double>(order) + 1, 0.5) << order;
  }
}

// Classical Runge-Kutta in long double, with steps far below what its order needs.
template <std::size_t N, class F>
std::array<long double, N> sampled(const F& f, std::array<long double, N> x, long double duration, int steps) {
  using X = std::array<long double, N>;
  const long double h = duration / steps;
  const auto plus = [](X a, long double s, const X& b) {
    for (std::size_t i = 0; i < N; ++i) a[i] += s * b[i];
    return a;
  };
  for (int k = 0; k < steps; ++k) {
    const X k1 = f(x), k2 = f(plus(x, h / 2, k1)), k3 = f(plus(x, h / 2, k2)), k4 = f(plus(x, h, k3));
    x = plus(plus(plus(plus(x, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
  }
  return x;
}

TEST(Flow, HoldsAllSolutionsFromABox) {
  const Recording f = record<2>([](const auto& x, const auto& u) { return pendulum(x, u); });
  const Balls<2> start{Ball(2, 1e-3), Ball(0.3, 1e-3)};
  const Balls<2> x = after<2>(f, start, 4);
  EXPECT_LT(x[0].rad, 0.02);  // the flow stretches the box ninefold
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> in(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const std::array<long double, 2> from{2 + 1e-3 * in(random), 0.3 + 1e-3 * in(random)};
    const auto end = sampled<2>([](const auto& s) { return pendulum(s); }, from, 4, 2000);
    for (std::size_t j = 0; j < 2; ++j) EXPECT_LE(std::abs(end[j] - x[j].mid), x[j].rad);
  }
}

TEST(Flow, StepsHoldTheSolutionAtAllTimes) {
  const Recording f = record<2>([](const auto& x, const auto& u) { return oscillator(x, u); });
  Flow<2> flow(f);
  flow.start({1.0, 0.0});
  double next = 0;
  ASSERT_TRUE(flow.run({}, 3.0, [&](const Step<2>& step) {
    EXPECT_LE(step.from.lower(), next);  // no gaps
    next = (step.from + step.length).upper();
    for (const double fraction : {0.0, 0.3, 0.7, 1.0}) {
      const Ball t = step.length * fraction;
      const long double exact = std::cos(2 * (static_cast<long double>(step.from.mid) + t.mid));
      const Ball x = polynomial(step.near[0], step.near[0].size(), t);
      EXPECT_LE(std::abs(exact - x.mid), x.rad + 2 * t.rad + kReference);
      EXPECT_LT(x.rad, kNarrow);
      EXPECT_LE(std::abs(exact - step.over[0][0].mid), step.over[0][0].rad + kReference);
    }
    return true;
  }));
  EXPECT_GE(next, 3);
}

// A step function of velocity as steep as the arm's friction: x' = -tanh(x / w) comes to rest, w = 1e-4.
TEST(Flow, FollowsASteepLawIntoItsRest) {
  const double w = 1e-4;
  const Recording f = record<1>([&](const auto& x, const auto&) { return std::array{-tanh(x[0] / w)}; });
  const Balls<1> x = after<1>(f, {0.01}, 0.012);
  // sinh(x/w) = sinh(x0/w) e^(-t/w)
  const long double u = (0.01L - 0.012L) / 1e-4L;
  expect_narrow_around(x[0], 1e-4L * std::asinh(std::exp(u) / 2));
}

// Undamped, and not circular: wrapped in a box at every step, the set would grow e^(2 pi)-fold a turn, and it turns 95
// times.
TEST(Flow, DoesNotWrapWhatOnlyTurns) {
  const Recording f = record<2>([](const auto& x, const auto& u) { return oscillator(x, u, 100); });
  const Balls<2> x = after<2>(f, {Ball(1, 1e-9), Ball(0, 1e-9)}, 60);
  EXPECT_LT(x[1].rad, 2e-8);
}

TEST(Flow, AModelThatIsOffByTenDigitsIsToldApart) {
  const Recording f = record<2>([](const auto& x, const auto& u) { return oscillator(x, u, 4 * (1 + 1e-10)); });
  const Balls<2> x = after<2>(f, {1.0, 0.0}, 10);
  EXPECT_GT(std::abs(std::cos(20.0L) - x[0].mid), 10 * x[0].rad);
}

TEST(Flow, SaysWhereItCannotGoOn) {
  const Recording f = record<1>([](const auto& x, const auto&) { return std::array{x[0] * x[0]}; });
  Flow<1> flow(f);
  flow.start({1.0});
  EXPECT_FALSE(flow.run({}, 2.0, ignore));  // 1 / (1 - t)
  EXPECT_GT(flow.reached(), 0.9);
  EXPECT_LT(flow.reached(), 1.0);
}

// However large a remainder may be: what is no enclosure is not taken for one.
TEST(Flow, ABoxThatDoesNotHoldWhatComesOutOfItIsNotBelieved) {
  const Recording f = record<1>([](const auto& x, const auto&) { return std::array{x[0] * x[0]}; });
  FlowOptions options;
  options.remainder = 1e30;
  Flow<1> flow(f, options);
  flow.start({1.0});
  EXPECT_FALSE(flow.run({}, 2.0, ignore));
  EXPECT_LT(flow.reached(), 1.0);
}

TEST(Flow, ADivisionByWhatMayBeZeroIsNoEnclosure) {
  const Recording f = record<1>([](const auto& x, const auto&) { return std::array{1.0 / x[0]}; });
  Flow<1> flow(f);
  flow.start({Ball(0, 1)});
  EXPECT_FALSE(flow.run({}, 1.0, ignore));
}

}  // namespace
}  // namespace enclosure
