// Runs on the simulated arm, and what they amount to.
#include "planner/certificate/simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "planner/certificate/residual.h"
#include "planner/certificate/run_figures.h"
#include "tests/support/exact_trajectories.h"

namespace fjr {
namespace {

constexpr double kCount = 9.587e-5;  // [rad]

Sample hanging(double time, double q2 = 0, Joints<double> torque = {}) {
  Sample sample{time, {}, torque};
  sample.state.q[1] = q2;
  return sample;
}

// Rests at q = 0 for two seconds.
Trajectory resting() { return {{hanging(0), hanging(2)}, {}}; }

TEST(RunFigures, AreThoseOfTheSamples) {
  Simulation run;
  run.completed = true;
  run.samples = {hanging(0, 0.01, {0, 1}), hanging(2, -0.03, {3, 1}), hanging(3, 0.02), hanging(4, kCount / 2)};
  const RunFigures figures = figures_of(robot(), resting(), run, kCount);
  EXPECT_DOUBLE_EQ(figures.effort, 6 + 2);  // int (3 t / 2)^2 + 1 over 2 s; what comes after the end is left out
  EXPECT_EQ(figures.link_error, (Joints<double>{0, 0.03}));
  EXPECT_EQ(figures.residual, (Joints<double>{0, 0.03}));
  EXPECT_EQ(figures.peaks.torque, (Joints<double>{3, 1}));
  EXPECT_EQ(figures.peaks.link_position, (Joints<double>{0, 0.03}));
  EXPECT_EQ(figures.peaks.spring_deflection, (Joints<double>{0, 0.03}));
  EXPECT_EQ(figures.settling_time, 1);  // at 3 s it was last too far

  run.torque_held = true;
  EXPECT_DOUBLE_EQ(figures_of(robot(), resting(), run, kCount).effort, 2 * (9 + 1));
}

TEST(RunFigures, WhatIsNotSeenToSettleDoesNotSettle) {
  Simulation run;
  run.completed = true;
  run.samples = {hanging(0), hanging(2), hanging(3, 2 * kCount)};
  EXPECT_EQ(figures_of(robot(), resting(), run, kCount).settling_time, kNoLimit);
  EXPECT_EQ(figures_of(robot(), resting(), run, 3 * kCount).settling_time, 0);
  run.completed = false;
  EXPECT_EQ(figures_of(robot(), resting(), run, 3 * kCount).settling_time, kNoLimit);
}

TEST(Simulate, AnArmThatRestsIsHeldAfterTheEnd) {
  Trajectory still;
  for (int k = 0; k <= 100; ++k) still.samples.push_back({k * 1e-3, rest_at(robot(), {0.4, -0.3}), {}});
  for (Sample& row : still.samples) row.torque = gravity_torque(robot(), row.state.q);
  const Simulation moved = simulate(robot(), robot(), still, ControlMode::kClosedLoop);
  EXPECT_EQ(moved.samples.back().time, still.end_time());
  const Simulation run = simulate(robot(), robot(), still, ControlMode::kClosedLoop, 1);
  ASSERT_TRUE(run.completed) << run.failure;
  EXPECT_NEAR(run.samples.back().time, 1.1, 1e-9);
  const RunFigures figures = figures_of(robot(), still, run, kCount);
  const Joints<double> held = deviation_at_rest(robot(), still.samples.back(), moved.samples.back().state);
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_LE(figures.residual[j], kCount);   // what every certificate asks for
    EXPECT_EQ(figures.residual[j], held[j]);  // as the certificate holds it, for the same second
  }
  EXPECT_EQ(figures.settling_time, 0);
}

// Held after the end too, it is the true arm's weight that the springs carry in the mean, whatever it swings by.
TEST(Simulate, TheArmThatIsHeldIsTheTrueOne) {
  Parameters heavier = robot();
  heavier.payload.mass = 0.05;
  const Joints<double> raised{0.8, 0};
  Trajectory still{{{0, rest_at(robot(), raised), {}}, {0.1, rest_at(robot(), raised), {}}}, {}};
  const Joints<double> more = gravity_torque(heavier, raised), less = gravity_torque(robot(), raised);
  for (Sample& row : still.samples) row.torque = less;
  const Simulation run = simulate(robot(), heavier, still, ControlMode::kClosedLoop, 1);
  ASSERT_TRUE(run.completed) << run.failure;
  double carried = 0, samples = 0;
  for (const Sample& sample : run.samples) {
    if (sample.time <= still.end_time()) continue;
    carried += robot().spring.stiffness[0] * (sample.state.theta[0] - sample.state.q[0]);
    ++samples;
  }
  EXPECT_GT(carried / samples, less[0] + 0.7 * (more[0] - less[0]));
  EXPECT_GT(figures_of(heavier, still, run, kCount).residual[0], 10 * kCount);
}

}  // namespace
}  // namespace fjr
