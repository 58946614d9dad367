// A component that is held between bounds, against closed forms, against its Taylor series, and what would have to
// fail.
#include "common/enclosure/held.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace enclosure {
namespace {

constexpr double kDecay = 8e4, kSpring = 300;  // [1/s], [1/s^2] about those of a motor that rests in steep friction
constexpr std::size_t kX = 0, kV = 1;

// x' = v, v' = u(t) - kSpring x - friction(v), with friction kDecay v near rest.
template <class Friction>
Recording motor(const Friction& friction) {
  Recording f(3);
  const Active x = f.input(kX), v = f.input(kV), u = f.input(2);
  f.output(v);
  f.output(u - kSpring * x - friction(v));
  return f;
}
Active linear(const Active& v) { return kDecay * v; }
constexpr double kWidth = 1.5e-4;
Active saturating(const Active& v) { return kDecay * kWidth * tanh((1 / kWidth) * v); }

// Of the linear one with u = a + b t, from (x, v): s (t - kDecay / kSpring) + a / kSpring + two exponentials, s = b /
// kSpring.
std::array<long double, 2> exact(long double x, long double v, long double a, long double b, long double t) {
  const long double root = std::sqrt(0.25L * kDecay * kDecay - kSpring), fast = -0.5L * kDecay - root,
                    slow = kSpring / fast, s = b / kSpring, rest = a / kSpring - s * kDecay / kSpring;
  const long double x0 = x - rest, v0 = v - s, c_fast = (v0 - slow * x0) / (fast - slow), c_slow = x0 - c_fast;
  const long double e_fast = c_fast * std::exp(fast * t), e_slow = c_slow * std::exp(slow * t);
  return {rest + s * t + e_fast + e_slow, s + fast * e_fast + slow * e_slow};
}

const auto ignore = [](const auto&) { return true; };

bool holds(const Ball& ball, long double value) { return std::abs(value - ball.mid) <= ball.rad; }

// What a step may leave open: 1e-6 rad/s beside the middle come to 1e-11 rad in all.
constexpr FlowOptions kOptions{.order = 12, .slope_order = 6, .remainder = 2e-11};

// Both tell the decay from 1e-6 rad/s beside: within the step, and at its end after 80 time constants.
TEST(HeldFlow, HoldsTheClosedForm) {
  const Recording f = motor(linear);
  HeldFlow<2> flow(f, kV, kOptions);
  for (const double begin : {1e-6, -3e-7, 0.0}) {
    Set<2> set(Balls<2>{Ball(0.01), Ball(begin)});
    const double a = 3, b = 20, h = 1e-3;
    int seen = 0;
    const Holding result = flow.run(set, {{a, b}}, h, [&](const Step<2>& step) {
      for (int i = 0; i <= 100; ++i) {
        const double t = step.length.mid * i / 100;
        const auto now = exact(0.01L, begin, a, b, step.from.mid + static_cast<long double>(t));
        for (const std::size_t j : {kX, kV}) {
          EXPECT_TRUE(holds(polynomial(step.near[j], step.near[j].size(), t), now[j])) << j << " at " << t;
          EXPECT_TRUE(holds(step.over[j][0], now[j])) << j;
        }
      }
      ++seen;
      return true;
    });
    ASSERT_EQ(result, Holding::kHeld);
    EXPECT_GT(seen, 0);
    const auto end = exact(0.01L, begin, a, b, h);
    const Balls<2> hull = set.hull();
    EXPECT_TRUE(holds(hull[kX], end[kX]));
    EXPECT_TRUE(holds(hull[kV], end[kV]));
    EXPECT_LT(hull[kX].rad, 1e-10);  // 1e-6 rad/s for 1 / kDecay
    EXPECT_LT(hull[kV].rad, 1e-11);  // what K times that drives, and the fit of w
  }
}

// From a box of starts, over ten times in a row, beside the Taylor series: neither can be outside of the other.
TEST(HeldFlow, AgreesWithTheTaylorSeries) {
  const Recording f = motor(saturating);
  const Balls<2> start{Ball(0.01, 1e-9), Ball(2e-5, 1e-9)};
  HeldFlow<2> held(f, kV, {.order = 12, .slope_order = 6, .remainder = 1e-9});
  Flow<2> taylor(f, {.order = 12, .slope_order = 6, .remainder = 1e-15});
  Set<2> set(start);
  taylor.start(start);
  for (int k = 0; k < 10; ++k) {
    const std::vector<Polynomial> u{{3 + 2 * std::sin(k), 100.0 * std::cos(3 * k)}};
    ASSERT_EQ(held.run(set, u, 1e-3, ignore), Holding::kHeld);
    ASSERT_TRUE(taylor.run(u, 1e-3, ignore));
    const Balls<2> a = set.hull(), b = taylor.set().hull();
    for (const std::size_t j : {kX, kV}) EXPECT_LE(std::abs(a[j].mid - b[j].mid), a[j].rad + b[j].rad);
    EXPECT_LT(a[kX].rad, 2e-8);  // the box, what steps leave open, and jumps of u by up to 2: 3e-5 rad/s for 1 / kDecay
  }
  EXPECT_LT(20 * held.steps(), taylor.steps());
}

// The middle is only as good as five powers of time: what it misses is in the bounds, and not forgotten.
TEST(HeldFlow, AllowsForWhatTheMiddleMisses) {
  const Recording f = motor(linear);
  HeldFlow<2> flow(f, kV, {.order = 12, .slope_order = 6, .remainder = 1e-6});
  HeldFlow<2> exacting(f, kV, {.order = 12, .slope_order = 6, .remainder = 1e-12});
  const double h = 1e-3;  // u = c t^7: w' = 7 c t^6 / kDecay has a part of its own
  Polynomial u(8);
  u[7] = 0.1 / std::pow(h, 7);
  Set<2> set(Balls<2>{Ball(0), Ball(0)});
  EXPECT_EQ(exacting.run(set, {u}, h, ignore), Holding::kNotHeld);  // it misses more than that
  ASSERT_EQ(flow.run(set, {u}, h, ignore), Holding::kHeld);
  const Balls<2> hull = set.hull();
  EXPECT_GT(hull[kV].rad, 1e-8);
  Flow<2> taylor(f, {.order = 12, .slope_order = 6, .remainder = 1e-15});
  taylor.start(Balls<2>{Ball(0), Ball(0)});
  ASSERT_TRUE(taylor.run({u}, h, ignore));
  const Balls<2> sharp = taylor.set().hull();
  for (const std::size_t j : {kX, kV}) EXPECT_LE(std::abs(hull[j].mid - sharp[j].mid), hull[j].rad + sharp[j].rad);
}

TEST(HeldFlow, HoldsNothingThatDecaysSlowlyOrGrows) {
  const std::vector<Polynomial> u{{1.0}};
  for (const double rate : {1e3, -8e4}) {
    const Recording f = motor([&](const Active& v) { return rate * v; });
    HeldFlow<2> flow(f, kV, kOptions);
    Set<2> set(Balls<2>{Ball(0), Ball(0)});
    const Balls<2> before = set.hull();
    EXPECT_EQ(flow.run(set, u, 1e-3, ignore), Holding::kNotHeld);
    EXPECT_EQ(set.hull()[kX].mid, before[kX].mid);
    EXPECT_EQ(flow.steps(), 0);
  }
}

// A push that takes it out of the steep part: the slope there does not hold it.
TEST(HeldFlow, LeavesAComponentThatBreaksAway) {
  const Recording f = motor(saturating);
  HeldFlow<2> flow(f, kV, kOptions);
  Set<2> set(Balls<2>{Ball(0), Ball(0)});
  EXPECT_EQ(flow.run(set, {{0.0, 3e4}}, 1e-3, ignore), Holding::kNotHeld);  // 30 after a millisecond, and 12 hold
  EXPECT_EQ(set.hull()[kX].mid, 0);
}

TEST(HeldFlow, StopsWhereTheObserverHasSeenEnough) {
  const Recording f = motor(linear);
  HeldFlow<2> flow(f, kV, kOptions);
  Set<2> set(Balls<2>{Ball(0), Ball(0)});
  EXPECT_EQ(flow.run(set, {{0.01}}, 1e-3, [](const auto&) { return false; }), Holding::kStopped);
  EXPECT_EQ(flow.reached(), 0);
}

}  // namespace
}  // namespace enclosure
