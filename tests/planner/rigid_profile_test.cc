// The profiles of rigid arms that the report compares a plan with.
#include "planner/results/report/rigid_profile.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <string>

#include "model/kinematics.h"
#include "tests/planner/reported_plan.h"

namespace fjr {
namespace {

class Profiles : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(, Profiles, testing::Values(Profile::kMinimumJerk, Profile::kTrapezoidal),
                         [](const auto& profile) {
                           return profile.param == Profile::kMinimumJerk ? "minimum_jerk" : "trapezoidal";
                         });

TEST_P(Profiles, LeadFromRestToRestAndAreTheirOwnDerivatives) {
  EXPECT_EQ(along(GetParam(), 0).position, 0);
  EXPECT_NEAR(along(GetParam(), 1).position, 1, 1e-15);
  EXPECT_EQ(along(GetParam(), 0).velocity, 0);
  EXPECT_NEAR(along(GetParam(), 1).velocity, 0, 1e-14);
  for (const double corner : {1.0 / 3, 2.0 / 3}) {  // of the trapezoid
    const Along before = along(GetParam(), corner - 1e-12), after = along(GetParam(), corner + 1e-12);
    EXPECT_NEAR(before.position, after.position, 1e-10);
    EXPECT_NEAR(before.velocity, after.velocity, 1e-10);
  }
  constexpr double kStep = 1e-5;
  for (double c = 0.01; c < 1; c += 0.0123) {  // never within a step of a jump
    const Along before = along(GetParam(), c - kStep), at = along(GetParam(), c), after = along(GetParam(), c + kStep);
    // Central differences: error kStep^2 / 6 times a third derivative of at most 360.
    EXPECT_NEAR((after.position - before.position) / (2 * kStep), at.velocity, 1e-8) << c;
    EXPECT_NEAR((after.velocity - before.velocity) / (2 * kStep), at.acceleration, 1e-7) << c;
  }
}

// With springs a hundred times as stiff the arm is nearly rigid, and the rigid arm's torque nearly exact: what is left
// after the end falls as the stiffness grows, acceleration / frequency^2. (Much stiffer ones the executor's feedback
// from the links, which goes by the spring, cannot hold with its ticks.)
TEST_P(Profiles, LeaveNoResidualOnAStiffArm) {
  const Joints<double> from{0.2, -0.3}, to{1.0, 0.5};
  const auto stiffened = [](double times) {
    Parameters robot = load_parameters(kRobot);
    for (double& stiffness : robot.spring.stiffness) stiffness *= times;
    return robot;
  };
  const auto reference_of = [&](double times) { return rigid_reference(stiffened(times), GetParam(), from, to, 0.8); };
  const auto run_with = [&](double times) { return run_on_elastic_arm(stiffened(times), reference_of(times)); };
  const ElasticRun soft = run_with(1), less_stiff = run_with(30), stiff = run_with(100);
  const Trajectory reference = reference_of(100);
  ASSERT_EQ(stiff.simulation.failure, "");
  double feed_forward = 0;
  for (const Sample& row : reference.samples) feed_forward = std::max(feed_forward, std::abs(row.torque[0]));
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_LT(stiff.figures.residual[j], 1e-3) << j;                              // measured: 7e-4 and less
    EXPECT_GT(soft.figures.residual[j], 50 * stiff.figures.residual[j]) << j;     // measured: 126 and more
    EXPECT_LT(stiff.figures.residual[j], 0.45 * less_stiff.figures.residual[j]);  // 0.3 by the law
  }
  EXPECT_EQ(stiff.figures.settling_time, 0);
  EXPECT_NEAR(stiff.figures.peaks.torque[0], feed_forward,
              0.05 * feed_forward);  // the feedback has next to nothing to do
}

// Motors that follow perfectly shake the links by s(t) alone. Linearised at the goal, every mode is an oscillator whose
// amplitude after the end is the Fourier transform of s'' at its frequency; computed here from the eigenvalues of the
// paper's matrices, with no integrator.
TEST_P(Profiles, ResidualIsThatOfTheLinearisedArm) {
  Parameters robot = load_parameters(kRobot);
  robot.motor.inertia = {1e5, 1e5};  // which no spring moves, and no encoder has to tell
  robot.drive.peak_torque = {1e9, 1e9};
  const Joints<double> from{-0.04, 0.03}, to{0.03, -0.03};
  constexpr double kDuration = 0.3;

  const MassMatrix<double> m = mass_matrix(robot, to[1]);
  Eigen::Matrix2d mass, stiffness;
  mass << m.m11, m.m12, m.m12, m.m22;
  const double second = robot.link.gravity_torque[1] * std::cos(to[0] + to[1]);  // dG/dq
  stiffness << robot.spring.stiffness[0] + robot.link.gravity_torque[0] * std::cos(to[0]) + second, second, second,
      robot.spring.stiffness[1] + second;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> modes(stiffness, mass);
  Eigen::Vector2d pull;  // K (theta at the end - theta at the start)
  for (std::size_t j = 0; j < kJoints; ++j) {
    pull[static_cast<Eigen::Index>(j)] =
        robot.spring.stiffness[j] * (rest_at(robot, to).theta[j] - rest_at(robot, from).theta[j]);
  }
  std::array<std::complex<double>, 2> amplitude;
  for (int i = 0; i < 2; ++i) {
    const double frequency = std::sqrt(modes.eigenvalues()[i]);
    constexpr int kSteps = 30000;
    std::complex<double> transform = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double c = (k + 0.5) / kSteps;
      transform +=
          along(GetParam(), c).acceleration * std::polar(1.0, -frequency * kDuration * c) / (kDuration * kSteps);
    }
    amplitude[static_cast<std::size_t>(i)] =
        -modes.eigenvectors().col(i).dot(pull) * transform / std::pow(frequency, 3);
  }
  Joints<double> expected{};
  for (double t = kDuration; t < kDuration + kWatchedAfterEnd; t += 1e-4) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      double off = 0;
      for (int i = 0; i < 2; ++i) {
        off +=
            modes.eigenvectors()(static_cast<Eigen::Index>(j), i) *
            std::imag(amplitude[static_cast<std::size_t>(i)] * std::polar(1.0, std::sqrt(modes.eigenvalues()[i]) * t));
      }
      expected[j] = std::max(expected[j], std::abs(off));
    }
  }

  const ElasticRun run = run_on_elastic_arm(robot, rigid_reference(robot, GetParam(), from, to, kDuration));
  ASSERT_EQ(run.simulation.failure, "");
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_GT(expected[j], 5e-3) << j;  // or nothing would be tested
    // Second order in angles of 0.07 rad.
    EXPECT_NEAR(run.figures.residual[j], expected[j], 0.02 * expected[j]) << j;
  }
}

}  // namespace
}  // namespace fjr
