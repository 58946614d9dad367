// The paper's derived constants follow from its measured ones, to the digits it prints; robot.yaml holds the printed
// ones.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/encoder.h"
#include "model/parameters.h"

namespace fjr {
namespace {

using std::numbers::pi;

// Printed, in the order of the paper.
constexpr double kStep = 4.7124e-3;                             // [rad] of the stiffness staircases
constexpr double kStiffness1 = 20.48, kStiffness2 = 17.75;      // [N m/rad]
constexpr double kGravitySlope1 = 6.70, kGravitySlope2 = 0.53;  // [N m] (6), (7)
constexpr double kDecay = 0.5745, kPeriod = 0.6509;             // [1/s] (13), [s] (14)
constexpr double kI1 = 0.2190, kI2 = 0.0116;                    // [kg m^2]
constexpr double kL1 = 0.345, kL2 = 0.305, kM1 = 1.570, kM2 = 0.660;
constexpr double kAlpha1 = 0.7420, kAlpha2 = 0.2687;

// Every tolerance below is half a unit of the last digit that the paper prints.

TEST(PaperNumbers, LinkInertiaFollowsFromDecayAndPeriod) {
  // (11), (13), (14): omega_s^2 = (2 pi / period)^2 + decay^2 = K1 / I1
  const double omega_squared = std::pow(2 * pi / kPeriod, 2) + kDecay * kDecay;
  EXPECT_NEAR(kStiffness1 / omega_squared, kI1, 0.5e-4);
  EXPECT_NEAR(2 * kDecay * kI1, 0.2516, 0.5e-4);  // D1, which the paper does not print but robot.yaml's comment does
}

TEST(PaperNumbers, GravityCoefficientsFollowFromTheSlopes) {
  EXPECT_NEAR(kGravitySlope1 - kGravitySlope2, 6.17, 0.5e-2);
}

TEST(PaperNumbers, CentresOfMassFollowWithGravityOf9Point8Only) {
  const auto alpha1 = [](double g) { return (kGravitySlope1 - kGravitySlope2 - kM2 * g * kL1) / (kM1 * g * kL1); };
  const auto alpha2 = [](double g) { return kGravitySlope2 / (kM2 * g * kL2); };
  EXPECT_NEAR(alpha1(9.8), kAlpha1, 0.5e-4);
  EXPECT_NEAR(alpha2(9.8), kAlpha2, 0.5e-4);
  EXPECT_GT(std::abs(alpha1(9.81) - kAlpha1), 0.5e-4);
  EXPECT_GT(std::abs(alpha2(9.81) - kAlpha2), 0.5e-4);
}

TEST(PaperNumbers, InertiasOfTheLinksFollowFromThoseAboutTheJoints) {
  // (18), with the rounded figures that the paper goes on with
  EXPECT_NEAR(kI1 - kM2 * kL1 * kL1 - kI2 - 2 * kAlpha2 * kM2 * kL1 * kL2, 0.0915, 0.5e-4);
  EXPECT_NEAR(kI2 - kM2 * std::pow(kAlpha2 * kL2, 2), 7.1672e-3, 0.5e-7);
}

TEST(PaperNumbers, StepsAreWholeOrHalfCountsOfTheMotorEncoders) {
  EXPECT_NEAR(kStep, 3 * count_angle(4000), 0.5e-7);
  EXPECT_NEAR(kStep, 1.5 * count_angle(2000), 0.5e-7);
  EXPECT_NEAR(7.8540e-3, 5 * count_angle(4000), 0.5e-7);
  EXPECT_NEAR(9.4248e-3, 3 * count_angle(2000), 0.5e-7);
}

TEST(PaperNumbers, StaircasesHaveAWholeNumberOfSteps) {
  EXPECT_NEAR(0.3864, 82 * kStep, 0.5e-4);
  EXPECT_NEAR(0.2262, 48 * kStep, 0.5e-4);
  EXPECT_NEAR(1.2174, 155 * 7.8540e-3, 0.5e-4);
  EXPECT_NEAR(1.4608, 155 * 9.4248e-3, 0.5e-4);
}

TEST(PaperNumbers, OneCountPerTickIsWhatTheDesignSays) {
  EXPECT_NEAR(count_angle(4000) / 1e-3, 1.57, 0.5e-2);  // [rad/s]
  EXPECT_NEAR(count_angle(2000) / 1e-3, 3.14, 0.5e-2);
  EXPECT_NEAR(count_angle(65536), 9.59e-5, 0.5e-7);  // [rad] the tolerance of the certificate
}

TEST(PaperNumbers, RobotFileHoldsThePrintedOnes) {
  const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  EXPECT_EQ(p.link.length, (Joints<double>{kL1, kL2}));
  EXPECT_EQ(p.link.mass, (Joints<double>{kM1, kM2}));
  EXPECT_EQ(p.link.com_fraction, (Joints<double>{kAlpha1, kAlpha2}));
  EXPECT_EQ(p.link.inertia, (Joints<double>{0.0915, 7.1672e-3}));
  EXPECT_EQ(p.link.gravity_torque, (Joints<double>{6.17, 0.53}));
  EXPECT_EQ(p.link.damping, (Joints<double>{0, 0}));
  EXPECT_EQ(p.spring.stiffness, (Joints<double>{kStiffness1, kStiffness2}));
  EXPECT_EQ(p.motor.inertia, (Joints<double>{0.0686, 0.0145}));
  EXPECT_EQ(p.friction.viscous, (Joints<double>{0.4968, 0.5051}));
  EXPECT_EQ(p.friction.amplitude, (Joints<double>{1.123, 0.8607}));
  EXPECT_EQ(p.friction.width, (Joints<double>{0.9505, 0.0174}));
  EXPECT_EQ(p.friction.second_weight, (Joints<double>{-0.7154, -0.1019}));
  EXPECT_EQ(p.friction.second_shape, (Joints<double>{-6539.2, 11.9636}));
  EXPECT_EQ(p.encoder.motor_counts, (Joints<double>{4000, 2000}));
  EXPECT_EQ(p.encoder.link_counts, (Joints<double>{65536, 65536}));
  EXPECT_EQ(p.limits.spring_deflection, (Joints<double>{0.3864, 0.2262}));
}

TEST(PaperNumbers, RobotFileHoldsTheAssumptionsOfTheDesign) {
  const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  EXPECT_EQ(p.limits.torque, (Joints<double>{12, 5}));
  EXPECT_EQ(p.limits.motor_velocity, (Joints<double>{6, 8}));
  EXPECT_EQ(p.limits.link_position, (Joints<double>{3.2, 2.6}));
  EXPECT_EQ(p.drive.peak_torque, (Joints<double>{14.4, 6}));
  EXPECT_EQ(p.feedback.position_gain, (Joints<double>{50, 20}));
  EXPECT_EQ(p.feedback.velocity_gain, (Joints<double>{2, 0.5}));
  EXPECT_EQ(p.feedback.velocity_filter, (Joints<double>{30, 30}));
  EXPECT_EQ(p.link.radius, (Joints<double>{0.03, 0.025}));
}

}  // namespace
}  // namespace fjr
