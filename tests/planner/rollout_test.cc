// Rollouts, what is compared with them, and local errors.
#include "planner/certificate/rollout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/certificate/comparison.h"
#include "planner/certificate/judge.h"
#include "planner/certificate/residual.h"
#include "support/exact_trajectories.h"

namespace fjr {
namespace {

// Seven stages a step and little more, at least one step a row; and where motor 1 rests in the steep part of its
// friction (80,000/s) no explicit steps, which would have to be shorter than 40 us. Where motor 2 is kept swinging as
// well, every tick's jump of the torque is followed at the certificate's accuracy.
TEST(Rollout, StaysCheap) {
  const Trajectory& plan = reference_trajectory();
  Rollout rollout(robot(), Limits{}, Accuracy::of_certificates());
  rollout.limit_step(longest_step(plan));
  rollout.start(0, plan.samples.front().state, Drive::closed_loop(plan, robot()));
  ASSERT_TRUE(rollout.run(plan.end_time(), {}, torque_corners(plan, 0), {}));
  EXPECT_LT(rollout.evaluations(), 11000);  // 8800 for 430 rows
  const Trajectory still = resting({0.5, 0.3}, 0.1);
  Drive holding = Drive::closed_loop(still, robot());
  for (const long most : {50'000L, 3000L}) {  // measured 25,000 with dither, 1000 without; explicit 20,000 without
    rollout.start(0, still.samples.front().state, holding);
    const long before = rollout.evaluations();
    ASSERT_TRUE(rollout.run(still.end_time(), {}, torque_corners(still, 0), {}));
    EXPECT_LT(rollout.evaluations() - before, most);
    holding.dither = nullptr;
  }
}

// Teeth of the torque: it jumps up by 8 N m within `gap` [s] every 0.5 us, and falls back until the next jump.
Trajectory teeth(double gap) {
  Trajectory t;
  const State<double> rest = rest_at(robot(), {0.3, 0.2});
  for (int k = 0; k < 2000; ++k) {
    for (const double jumped : {0.0, 1.0}) {
      t.samples.push_back({5e-7 * k + jumped * gap, rest, {8 * jumped, 0}});
    }
  }
  return t;
}

// However near a jump is to the corner before it, no step begins with the torque before the jump: that would count as
// a part of the step, 35/384 with the explicit method, and move the motor by 3e-4 rad/s here.
TEST(Rollout, BeginsNoStepBeforeAJumpThatIsNearTheLastCorner) {
  State<double> ends[2];
  for (int i = 0; i < 2; ++i) {
    const Trajectory t = teeth(i == 0 ? 0.9e-10 : 1.2e-10);
    Rollout rollout(robot(), Limits{}, Accuracy::of_certificates());
    rollout.limit_step(longest_step(t));
    rollout.start(0, t.samples.front().state, Drive::open_loop(t));
    ASSERT_TRUE(rollout.run(t.end_time(), {}, torque_corners(t, 0), {}));
    ends[i] = rollout.state();
  }
  // The jumps themselves are passed over: 4 N m for 2000 times 0.09 ns, over the motor's inertia.
  EXPECT_NEAR(ends[0].dtheta[0], ends[1].dtheta[0], 1.1e-5);
  EXPECT_GT(std::abs(ends[0].dtheta[0]), 1e-2);  // 4 N m in the mean, for 1 ms
}

TEST(Rollout, ConservesEnergyWithoutFrictionAndTorque) {
  Parameters p = robot();
  p.friction.viscous = p.friction.amplitude = {0, 0};
  p.link.damping = {0, 0};
  State<double> x = rest_at(p, {1.1, -0.7});
  x.dq = {2, -3};
  x.dtheta = {-1, 4};
  Rollout rollout(p, Limits{}, Accuracy::of_certificates());
  rollout.limit_step(kLongestStep);
  const double before = energy(p, x);
  double drift = 0;
  std::vector<double> instants;
  for (int k = 1; k <= 200; ++k) instants.push_back(0.01 * k);
  rollout.start(0, x, Drive::holding({}));
  ASSERT_TRUE(rollout.run(2.0, instants, {}, [&](double, const State<double>& y) {
    drift = std::max(drift, std::abs(energy(p, y) - before));
  }));
  EXPECT_GT(std::abs(rollout.state().q[0] - x.q[0]), 0.01);  // it did move
  EXPECT_LT(drift, 1e-5 * before);  // relative accuracy 1e-8 a step, some ten thousand steps, errors of either sign
}

TEST(Rollout, RecordsReversalsAndLimitCrossings) {
  Limits limits;
  limits.motor_velocity = {0.5, kNoLimit};
  Rollout rollout(robot(), limits, Accuracy::of_certificates());
  const Trajectory& plan = reference_trajectory();
  rollout.limit_step(longest_step(plan));
  rollout.start(0, plan.samples.front().state, Drive::open_loop(plan));
  ASSERT_TRUE(rollout.run(plan.end_time(), {}, {}, {}));
  Interpolator at(plan);
  int reversals = 0, crossings = 0;
  for (const Event& event : rollout.events()) {
    const double v = at.at(event.time).state.dtheta[static_cast<std::size_t>(event.joint - 1)];
    if (event.exceeded == nullptr) {
      EXPECT_NEAR(v, 0, 2e-3) << event.time;
      ++reversals;
    } else {
      EXPECT_STREQ(event.exceeded->name, "motor_velocity");
      EXPECT_NEAR(std::abs(v), 0.5, 1e-4) << event.time;
      ++crossings;
    }
  }
  EXPECT_GE(reversals, 2);
  EXPECT_GE(crossings, 1);
}

// slope(0)/J2 = 365/s: the deviation of a motor at rest grows by e^3.65 in 10 ms, as long as it stays far inside the
// band.
TEST(Rollout, MotorTwoLeavesRestExponentially) {
  const Sample rest{0, rest_at(robot(), {0.5, 0.3}), gravity_torque(robot(), Joints<double>{0.5, 0.3})};
  Accuracy accuracy = Accuracy::of_certificates();
  accuracy.motor_velocity = accuracy.link_velocity = accuracy.position = 1e-16;
  Rollout rollout(robot(), Limits{}, accuracy);
  rollout.limit_step(kLongestStep);
  State<double> x = rest.state;
  x.dtheta[1] = 1e-9;
  rollout.start(0, x, Drive::holding(rest));
  const std::vector<double> instants{0.01, 0.02};
  std::vector<double> v;
  ASSERT_TRUE(rollout.run(0.02, instants, {}, [&](double, const State<double>& y) { v.push_back(y.dtheta[1]); }));
  // The spring pulls back a little: s^2 J + slope s + K = 0 has its larger root at 361.5/s.
  const double slope = FrictionLaw::of(robot(), 1).slope(0), j = robot().motor.inertia[1],
               k = robot().spring.stiffness[1];
  const double rate = (-slope + std::sqrt(slope * slope - 4 * j * k)) / (2 * j);
  EXPECT_NEAR(std::log(v[1] / v[0]) / 0.01, rate, 0.01 * rate);
  EXPECT_NEAR(rate, 365, 10);
}

// std::max drops a NaN. The first of these rows cannot be interpolated to the next: their difference overflows.
TEST(Comparison, WhatIsNotANumberCountsAsInfinite) {
  Trajectory trajectory = reference_trajectory();
  trajectory.samples[7].state.q[1] = 1.7e308;
  trajectory.samples[8].state.q[1] = -1.7e308;
  Rollout rollout(robot(), Limits{}, Accuracy::of_certificates());
  const Comparison open =
      compare(rollout, robot(), trajectory, Drive::open_loop(trajectory), comparison_instants(trajectory));
  EXPECT_EQ(open.errors.link[1], kNoLimit);
}

// BDF with long steps would damp the instability away and certify a rest that cannot be held.
TEST(Certificate, InstabilityIsSeenHoweverFarTheRowsAreApart) {
  Trajectory trajectory = resting({0.5, 0.3}, 0.3);
  trajectory.samples = {trajectory.samples.front(), trajectory.samples.back()};
  trajectory.samples.front().state.dtheta[1] += 1e-12;
  Rollout rollout(robot(), Limits{}, Accuracy::of_certificates());
  const Comparison open =
      compare(rollout, robot(), trajectory, Drive::open_loop(trajectory), comparison_instants(trajectory));
  EXPECT_GT(open.errors.link[1], 1e-4);
  Trajectory brief = resting({0.5, 0.3}, 0.002);
  brief.samples.front().state.dtheta[1] += 1e-8;
  EXPECT_GT(certificate_of(brief).residual.open_loop_drift[1], 5e-4);
}

// ---- local errors ----

TEST(LocalErrors, SitWhereTheForgeryIsAndNowhereElse) {
  Trajectory trajectory = reference_trajectory();
  std::vector<double> times;
  for (std::size_t k = 0; k <= 430; k += 10) times.push_back(trajectory.samples[k].time);
  trajectory.samples[105].torque[1] += 0.1;
  Interpolator plan(trajectory);
  const TorqueLaw tau = [&](double t, const State<double>&) { return plan.torque_at(t); };
  const State<double> end = integrate(tau, times[10], times[11], trajectory.samples[100].state);
  const std::vector<State<double>> errors = local_errors(robot(), trajectory, times);
  ASSERT_EQ(errors.size(), 43u);
  for (std::size_t k = 0; k < errors.size(); ++k) {
    for (int i = 0; i < kStates; ++i) {
      const double expected = k == 10 ? end[i] - trajectory.samples[110].state[i] : 0;
      const bool velocity = i % 4 >= 2;
      EXPECT_NEAR(errors[k][i], expected, velocity ? 1e-5 : 2e-7) << k << ", " << i;
    }
  }
  EXPECT_GT(std::abs(errors[10].dtheta[1]), 1e-4);
}

// Mesh times are computed and row times are read: they may differ in the last bit, next to a corner of the torque too.
TEST(LocalErrors, DoNotMindTimesThatDifferByRounding) {
  Trajectory trajectory = reference_trajectory();
  trajectory.samples[100].torque[0] += 3;  // corners at rows 99, 100 and 101
  std::vector<double> times;
  for (std::size_t k = 97; k <= 103; ++k) {
    const double t = trajectory.samples[k].time;
    times.push_back(k % 2 == 0 ? std::nextafter(t, 1) : std::nextafter(t, 0));
  }
  for (const State<double>& error : local_errors(robot(), trajectory, times)) EXPECT_LT(std::abs(error.q[0]), 1e-4);
  for (double& t : times) t = trajectory.samples[99].time + 3e-17;
  for (const State<double>& error : local_errors(robot(), trajectory, times)) EXPECT_EQ(error.q[0], 0);
}

}  // namespace
}  // namespace fjr
