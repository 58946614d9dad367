// Motor friction against a second evaluation of (24), figures known beforehand, and what its smoothed family
// promises; encoders and the velocity filter at the end.
#include "model/friction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "common/dual.h"
#include "model/encoder.h"
#include "tests/support/arbitrary.h"

namespace fjr {
namespace {

FrictionLaw law(int joint) {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  return FrictionLaw::of(p, joint);
}

// (24) with extended precision and tanh from exponentials.
long double tanh_by_exponentials(long double x) {
  const long double e = std::expm1(2 * std::abs(x));
  return std::copysign(std::isinf(e) ? 1.0L : e / (e + 2), x);
}

double torque_24(const FrictionLaw& f, double v) {
  const long double s = static_cast<long double>(v) / f.width;
  const long double first = tanh_by_exponentials(s);
  return static_cast<double>(f.viscous * static_cast<long double>(v) + f.amplitude * first -
                             f.amplitude * static_cast<long double>(f.second_weight) *
                                 tanh_by_exponentials(s - f.second_shape * first));
}

// Where `f` changes sign in [low, high].
double root(const std::function<double(double)>& f, double low, double high) {
  const bool rising = f(high) > 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == rising ? high : low) = middle;
  }
  return low;
}

// Velocities of every size: 10^-8 to 10^1 rad/s, of either sign.
double any_velocity() { return std::copysign(std::pow(10.0, between(-8, 1)), between(-1, 1)); }

RC_GTEST_PROP(Friction, IsEquation24, ()) {
  const double v = any_velocity();
  for (int joint = 0; joint < kJoints; ++joint) {
    // A few roundings of up to 7 N m; x sech^2 x <= 0.45 keeps the rounding of the second argument as small.
    RC_ASSERT(std::abs(law(joint).torque(v) - torque_24(law(joint), v)) < 1e-14);
  }
}

RC_GTEST_PROP(Friction, IsOdd, ()) {
  const double v = any_velocity(), eps = std::pow(10.0, between(-6, 0));
  for (int joint = 0; joint < kJoints; ++joint) {
    RC_ASSERT(law(joint).torque(-v) == -law(joint).torque(v));
    RC_ASSERT(law(joint).smoothed(eps).torque(-v) == -law(joint).smoothed(eps).torque(v));
  }
}

RC_GTEST_PROP(Friction, SlopeIsTheDerivative, ()) {
  const double v = any_velocity();
  for (int joint = 0; joint < kJoints; ++joint) {
    const double exact = law(joint).torque(Dual<1>::input(v, 0)).g[0], slope = law(joint).slope(v);
    // 1 - tanh^2 is lost to rounding where tanh is near one, times 6,000 N m s/rad.
    RC_ASSERT(std::abs(slope - exact) < 1e-11);
  }
}

// ---- figures known beforehand: tolerances are half a unit of their last digit ----

// The closed form against (24) carried through dual numbers. Rounded to 1e-12 of what the narrower of the two steps,
// which is as wide as eta / (1 + |h|), makes of the amplitude.
RC_GTEST_PROP(Friction, HasTheDerivativesThatDualNumbersCarry, ()) {
  const double v = any_velocity(), eps = std::pow(10.0, between(-6, 0));
  for (int joint = 0; joint < kJoints; ++joint) {
    const FrictionLaw f = law(joint).smoothed(eps);
    const Dual2<1> at = Dual2<1>::input(v, 0), s = at / f.width, first = tanh(s);
    const Dual2<1> carried = f.amplitude * first - f.amplitude * f.second_weight * tanh(s - f.second_shape * first),
                   closed = f.nonlinear(at);
    const double rounding = 1e-12 * f.amplitude, narrow = f.width / (1 + std::abs(f.second_shape));
    RC_ASSERT(std::abs(closed.v - carried.v) <= rounding);
    RC_ASSERT(std::abs(closed.g[0] - carried.g[0]) <= rounding / narrow);
    RC_ASSERT(std::abs(closed.second(0, 0) - carried.second(0, 0)) <= rounding / (narrow * narrow));
  }
}

TEST(Friction, OfJoint1IsAStepOfTheStatedWidthAndHeight) {
  const FrictionLaw f = law(0);
  EXPECT_NEAR(f.width / (1 - f.second_shape), 1.45e-4, 0.5e-6);
  EXPECT_NEAR(-f.amplitude * f.second_weight, 0.803, 0.5e-3);
  EXPECT_NEAR(f.slope(0), 5500, 50);
}

TEST(Friction, OfJoint1IncreasesAndItsInverseRoundTrips) {
  const FrictionLaw f = law(0);
  ASSERT_TRUE(f.increasing());
  for (double v = 1e-9; v < 2e3; v *= 3.7) {  // twelve decades
    // tau / (v slope) <= 500 (just beyond the step) roundings
    EXPECT_NEAR(f.velocity(f.torque(v)), v, 2e-13 * v);
    EXPECT_NEAR(f.velocity(-f.torque(v)), -v, 2e-13 * v);
  }
  EXPECT_EQ(f.velocity(0), 0);
  EXPECT_NEAR(f.velocity(0.5), 1.06e-4, 0.5e-6);
}

TEST(Friction, OfJoint2HasNoInverse) {
  EXPECT_FALSE(law(1).increasing());
  EXPECT_THROW(law(1).velocity(0.5), std::domain_error);
}

TEST(Friction, OfJoint2IsUnstableAtRest) {
  const FrictionLaw f = law(1);
  EXPECT_NEAR(f.slope(0), -5.29, 0.5e-2);
  EXPECT_NEAR(-f.slope(0) / 0.0145, 365, 0.5);  // [1/s] growth of deviations, over J2
  const double lowest = root([&](double v) { return f.slope(v); }, 1e-6, 9e-4);
  EXPECT_NEAR(lowest, 5.08e-4, 0.5e-6);
  EXPECT_NEAR(f.torque(lowest), -1.77e-3, 0.5e-5);
  EXPECT_NEAR(root([&](double v) { return f.torque(v); }, lowest, 5e-3), 9.05e-4, 0.5e-6);
  EXPECT_NEAR(root([&](double v) { return f.torque(v) - 0.5; }, lowest, 0.1), 1.42e-2, 0.5e-4);
}

// ---- the smoothed family ----

// Largest difference from the exact law over |v| in [from, 10 rad/s].
double distance(const FrictionLaw& a, const FrictionLaw& b, double from) {
  double largest = 0;
  for (double v = from; v < 10; v *= 1.01) largest = std::max(largest, std::abs(a.torque(v) - b.torque(v)));
  return largest;
}

// The laws of both joints, and others whose second tanh is wider than their first.
class Smoothed : public testing::TestWithParam<FrictionLaw> {};

TEST_P(Smoothed, ByNothingIsTheLawItself) {
  const FrictionLaw f = GetParam(), s = f.smoothed(0);
  EXPECT_EQ(s.width, f.width);
  EXPECT_EQ(s.second_shape, f.second_shape);
}

TEST_P(Smoothed, ConvergesToTheExactLawAwayFromTheStep) {
  const FrictionLaw f = GetParam();
  double before = distance(f.smoothed(0.1), f, 0.02);
  for (double eps = 0.03; eps > 1e-5; eps *= 0.3) {
    const double now = distance(f.smoothed(eps), f, 0.02);
    EXPECT_LT(now, before) << eps;
    before = now;
  }
  // The widths grow like eps^2/(2 eta) then: relative to joint 2's 0.0174 rad/s that is 4e-8 at 5e-6 rad/s.
  EXPECT_LT(distance(f.smoothed(5e-6), f, 0.02), 1e-7);
  // Everywhere, once eps is far below the narrowest feature (1.45e-4 rad/s).
  EXPECT_LT(distance(f.smoothed(1e-7), f, 1e-8), 1e-6);
}

TEST_P(Smoothed, HasNoFeatureNarrowerThanItsWidth) {
  const FrictionLaw f = GetParam();
  for (double eps = 0.3; eps > 1e-4; eps *= 0.5) {
    const FrictionLaw s = f.smoothed(eps);
    // Both steps together, each of the slope height over width.
    const double steepest = f.viscous + f.amplitude * (1 + std::abs(f.second_weight)) / eps;
    double reached = 0;
    for (double v = 1e-6; v < 10; v *= 1.01) reached = std::max(reached, std::abs(s.slope(v)));
    EXPECT_LE(std::max(reached, std::abs(s.slope(0))), steepest) << eps;
  }
}

INSTANTIATE_TEST_SUITE_P(Friction, Smoothed,
                         testing::Values(law(0), law(1), FrictionLaw{0.5, 1, 0.02, 0.5, 0.3},
                                         FrictionLaw{0.5, 1, 0.02, -0.5, 0.9}, FrictionLaw{0.5, 1, 0.02, 0.5, 0}),
                         [](const auto& of) { return "Law" + std::to_string(of.index); });

TEST(Friction, SmoothingOfJoint2KeepsTheFarKinkInItsPlace) {
  const FrictionLaw f = law(1);
  const double kink = f.second_shape * f.width;  // 0.208 rad/s
  for (const double eps : {0.03, 0.01, 0.001}) {
    const FrictionLaw s = f.smoothed(eps);
    const auto second = [&](double v) { return s.nonlinear(v) - s.amplitude * std::tanh(v / s.width); };
    // tanh(v/width) is one there to 2e-5 at eps = 0.03, and to much less below.
    EXPECT_NEAR(root(second, 0.1, 0.4), kink, 3e-5 * kink) << eps;
  }
}

// ---- encoders ----

RC_GTEST_PROP(Encoder, ReportsTheNearestCount, ()) {
  const double angle = between(-4, 4), counts = 4000;
  const double reported = quantised(angle, counts);
  RC_ASSERT(std::abs(reported - angle) <= count_angle(counts) / 2 + 1e-15);
  RC_ASSERT(quantised(reported, counts) == reported);
  const double whole = reported / count_angle(counts);
  RC_ASSERT(std::abs(whole - std::round(whole)) < 1e-12);  // 2,500 counts at most: a few roundings
}

constexpr double kCutoff = 30, kPeriod = 1e-3;  // [Hz], [s] as the executor's
const double kKeep = std::exp(-2 * std::numbers::pi * kCutoff * kPeriod);

TEST(VelocityFilter, ConvergesToAConstantVelocityLikeAFirstOrderLowPass) {
  VelocityFilter filter(kCutoff, kPeriod);
  filter.reset(0.3, 0);
  constexpr double kVelocity = 2.5;
  for (int tick = 1; tick <= 200; ++tick) {
    const double filtered = filter.update(0.3 + kVelocity * kPeriod * tick);
    // exp(-t / time constant) is left at t; differences of positions lose 1e-16 / 1e-3 s
    EXPECT_NEAR(filtered, kVelocity * (1 - std::exp(-2 * std::numbers::pi * kCutoff * kPeriod * tick)), 1e-12);
  }
}

// As if the position had been measured in between, on the straight line to where it is after them.
TEST(VelocityFilter, KnowsOfMissedPeriods) {
  VelocityFilter each(kCutoff, kPeriod), late(kCutoff, kPeriod);
  for (VelocityFilter* filter : {&each, &late}) filter->reset(0.3, 1.5);
  for (const int periods : {1, 2, 6}) {
    double of_each = 0;
    for (int i = 1; i <= periods; ++i) of_each = each.update(0.3 + 0.01 * i / periods);
    EXPECT_NEAR(late.update(0.31, periods), of_each, 1e-12) << periods;  // differences lose 1e-16 / 1e-3 s
    for (VelocityFilter* filter : {&each, &late}) filter->shift(-0.01);
  }
}

TEST(VelocityFilter, StartsFromTheVelocityItIsGiven) {
  VelocityFilter filter(kCutoff, kPeriod);
  filter.reset(-1, 4);
  for (int tick = 1; tick <= 50; ++tick) EXPECT_NEAR(filter.update(-1 + 4 * kPeriod * tick), 4, 1e-12);
}

TEST(VelocityFilter, AttenuatesTheNoiseOfOneCount) {
  const double count = count_angle(4000), raw = count / kPeriod;  // 1.57 rad/s
  VelocityFilter flicker(kCutoff, kPeriod), step(kCutoff, kPeriod);
  flicker.reset(0, 0);
  double largest = 0;
  for (int tick = 1; tick <= 400; ++tick) {
    const double filtered = std::abs(flicker.update(tick % 2 == 0 ? 0 : count));
    if (tick > 200) largest = std::max(largest, filtered);
  }
  // The gain of the low-pass at half the sampling rate, (1 - k) / (1 + k) = 0.094; the start is forgotten by k^200.
  EXPECT_NEAR(largest, raw * (1 - kKeep) / (1 + kKeep), 1e-12);
  step.reset(0, 0);
  EXPECT_NEAR(step.update(count), raw * (1 - kKeep), 1e-12);
  EXPECT_NEAR(step.update(count), raw * (1 - kKeep) * kKeep, 1e-12);
}

}  // namespace
}  // namespace fjr
