// Certificates against what must be true: trajectories that are exact by construction pass, every falsified column is
// refused with its reason, and the figures agree with an integration by fixed steps that shares no code with CVODE.
#include "planner/certificate/certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "planner/certificate/amplification.h"
#include "planner/certificate/comparison.h"
#include "planner/certificate/judge.h"
#include "planner/certificate/limits.h"
#include "planner/certificate/perturbed.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/rollout.h"
#include "planner/certificate/tracking.h"
#include "planner/control/motor_feedback.h"
#include "support/exact_trajectories.h"
#include "support/linearised_arm.h"

namespace fjr {
namespace {

using std::numbers::pi;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// ---- exact trajectories pass ----

TEST(Certificate, ExactTrajectoryIsCertifiedWithErrorsFarBelowTheTolerance) {
  const Certificate c = certificate_of(reference_trajectory());
  EXPECT_THAT(c.failures, IsEmpty());
  EXPECT_TRUE(c.certified);
  EXPECT_NEAR(c.tolerance, 9.587e-5, 1e-8);
  EXPECT_THAT(c.open_loop.why_not_in_one_run(), IsEmpty());
  EXPECT_TRUE(c.open_loop.completed);
  EXPECT_LT(c.open_loop.max_link(), 0.01 * c.tolerance);  // a share of the tolerance that cannot change a verdict
  EXPECT_LT(c.closed_loop.max_link(), 0.01 * c.tolerance);
  EXPECT_LT(c.open_loop.max_motor(), 0.01 * c.tolerance);
  EXPECT_LT(c.closed_loop.feedback_torque[0], 0.1 * 0.12);  // a tenth of what is allowed
  EXPECT_EQ(c.limits.size(), 8u);
  EXPECT_FALSE(c.residual.evaluated);  // it ends in motion
}

TEST(Certificate, IsTheSameToTheBitTheSecondTime) {
  const Certificate a = certificate_of(reference_trajectory()), b = certificate_of(reference_trajectory());
  EXPECT_EQ(a.open_loop.link, b.open_loop.link);
  EXPECT_EQ(a.open_loop.motor, b.open_loop.motor);
  EXPECT_EQ(a.closed_loop.feedback_torque, b.closed_loop.feedback_torque);
  EXPECT_EQ(a.tracking.link_error_rms, b.tracking.link_error_rms);
}

// ---- every falsified column is refused ----

using Rows = std::vector<Sample>;

struct Forgery {
  const char* name;
  std::function<void(Rows&)> apply;
  const char* reason;
};

std::ostream& operator<<(std::ostream& out, const Forgery& forgery) { return out << forgery.name; }

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Applies a change to every row.
template <class Change>
std::function<void(Rows&)> all(Change change) {
  return [change](Rows& rows) { std::for_each(rows.begin(), rows.end(), change); };
}

void zigzag(Rows& rows) {
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k].state.dq[1] += k % 2 == 0 ? 0.03 : -0.03;
}

const Forgery kForgeries[] = {
    {"OneTorqueRow", [](Rows& r) { r[100].torque[1] += 0.1; }, "open loop: link 2"},
    {"TorqueScaled", all([](Sample& row) { row.torque[0] *= 1.002; }), "open loop: link"},
    {"TorqueMirrored", all([](Sample& row) { row.torque[1] *= -1; }), "feedback torque of joint 2"},
    {"LinkRowShifted", [](Rows& r) { r[300].state.q[0] += 1.5e-4; }, "closed loop: link 1"},
    {"LastLinkRowShifted", [](Rows& r) { r.back().state.q[1] += 1.5e-4; }, "link 2"},
    {"StartShifted", [](Rows& r) { r.front().state.theta[1] += 2e-3; }, "link 2"},
    {"LinkVelocityScaled", all([](Sample& row) { row.state.dq[0] *= 1.05; }), "dq1 disagrees"},
    {"OneLinkVelocityRow", [](Rows& r) { r[100].state.dq[1] += 0.03; }, "dq2 disagrees"},
    {"LinkVelocityZigzag", zigzag, "the velocity of link 2"},
    {"MotorVelocityScaled", all([](Sample& row) { row.state.dtheta[0] *= 1.02; }), "dtheta1 disagrees"},
    {"MotorVelocityMissing", all([](Sample& row) { row.state.dtheta[1] = 0; }), "dtheta2 disagrees"},
    {"MotorPositionsShifted", all([](Sample& row) { row.state.theta[0] += 5e-3; }), "closed loop"},
    {"NotFinite", [](Rows& r) { r[7].torque[0] = kNaN; }, "row 8 holds a value that is not finite"},
    {"TimeBackwards", [](Rows& r) { r[7].time = r[6].time; }, "time does not increase at row 8"},
    {"OneRow", [](Rows& r) { r.resize(1); }, "fewer than two rows"},
    {"TooLong", [](Rows& r) { r.back().time = 1e6; }, "the trajectory takes 1e+06 s"},
    {"HugeTorque", all([](Sample& row) { row.torque[0] = 1e300; }), "open loop: "},
};

class Forgeries : public testing::TestWithParam<Forgery> {};

TEST_P(Forgeries, AreRefusedWithTheReason) {
  Trajectory trajectory = reference_trajectory();
  GetParam().apply(trajectory.samples);
  const Certificate c = certificate_of(trajectory);
  EXPECT_FALSE(c.certified);
  EXPECT_THAT(c.failures, testing::Contains(HasSubstr(GetParam().reason)));
}

INSTANTIATE_TEST_SUITE_P(Certificate, Forgeries, testing::ValuesIn(kForgeries),
                         [](const testing::TestParamInfo<Forgery>& test) { return test.param.name; });

// A plan that bulges smoothly by `height` in the middle, positions and velocities alike, is off by exactly that.
TEST(Certificate, OneCountIsTheBoundary) {
  for (const double height : {0.3, 0.9, 1.1}) {
    Trajectory trajectory = reference_trajectory();
    const double bulge = height * 9.587e-5, w = 2 * pi / trajectory.end_time();
    for (Sample& row : trajectory.samples) {
      row.state.q[0] += 0.5 * bulge * (1 - std::cos(w * row.time));
      row.state.dq[0] += 0.5 * bulge * w * std::sin(w * row.time);
    }
    const Certificate c = certificate_of(trajectory);
    EXPECT_EQ(c.certified, height < 0.5);
    if (height == 0.9) {
      EXPECT_THAT(c.failures, ElementsAre(HasSubstr("from half a count off the start: link 1")));
    } else if (height > 1) {
      EXPECT_THAT(c.failures, testing::Contains(HasSubstr("open loop: link 1")));
    }
    EXPECT_NEAR(c.open_loop.link[0], bulge, 1e-6);
    EXPECT_NEAR(c.open_loop.time_of_max_link, 0.215, 0.01);
  }
}

// ---- the figures agree with fixed steps ----

struct FixedSteps {
  Joints<double> link{}, motor{}, final_link{}, feedback{};
};

FixedSteps by_fixed_steps(const Trajectory& trajectory, const Joints<double>& kp, const Joints<double>& kd) {
  FixedSteps out;
  Interpolator plan(trajectory);
  const auto feedback = [&](double t, const State<double>& x) {
    const State<double> wanted = plan.at(t).state;
    return Joints<double>{kp[0] * (wanted.theta[0] - x.theta[0]) + kd[0] * (wanted.dtheta[0] - x.dtheta[0]),
                          kp[1] * (wanted.theta[1] - x.theta[1]) + kd[1] * (wanted.dtheta[1] - x.dtheta[1])};
  };
  const TorqueLaw tau = [&](double t, const State<double>& x) {
    const Joints<double> planned = plan.torque_at(t), f = feedback(t, x);
    return Joints<double>{planned[0] + f[0], planned[1] + f[1]};
  };
  State<double> x = trajectory.samples.front().state;
  for (std::size_t k = 1; k < trajectory.samples.size(); ++k) {
    const double t = trajectory.samples[k].time;
    x = integrate(tau, trajectory.samples[k - 1].time, t, x);
    for (std::size_t j = 0; j < kJoints; ++j) {
      out.final_link[j] = std::abs(x.q[j] - trajectory.samples[k].state.q[j]);
      out.link[j] = std::max(out.link[j], out.final_link[j]);
      out.motor[j] = std::max(out.motor[j], std::abs(x.theta[j] - trajectory.samples[k].state.theta[j]));
      out.feedback[j] = std::max(out.feedback[j], std::abs(feedback(t, x)[j]));
    }
  }
  return out;
}

TEST(Certificate, FiguresAgreeWithFixedSteps) {
  Trajectory trajectory = reference_trajectory();
  all([](Sample& row) { row.torque = {1.03 * row.torque[0], 0.95 * row.torque[1]}; })(trajectory.samples);
  const Certificate c = certificate_of(trajectory);
  const FixedSteps open = by_fixed_steps(trajectory, {}, {});
  const FixedSteps closed = by_fixed_steps(trajectory, robot().feedback.position_gain, robot().feedback.velocity_gain);
  // 1e-6 rad is a hundredth of what is judged. Maxima over rows alone and over all instants differ in second order.
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_GT(open.link[j], 1e-3);
    EXPECT_NEAR(c.open_loop.link[j], open.link[j], 1e-6);
    EXPECT_NEAR(c.open_loop.final_link[j], open.final_link[j], 1e-6);
    EXPECT_NEAR(c.closed_loop.link[j], closed.link[j], 1e-6);
    EXPECT_NEAR(c.closed_loop.feedback_torque[j], closed.feedback[j], 1e-3 * closed.feedback[j]);
  }
}

// Largest feedback torque over all steps of 2e-8 to 4e-6 s: where motor 1 passes through its friction step, peaks are
// shorter than instants are apart.
Joints<double> largest_feedback(const Trajectory& trajectory) {
  Interpolator plan(trajectory);
  const Drive closed = Drive::closed_loop(trajectory, robot());
  Joints<double> largest{};
  const TorqueLaw tau = [&](double t, const State<double>& x) {
    const Sample planned = plan.at(t);
    const Joints<double> f = closed.feedback(planned.state, x);
    for (std::size_t j = 0; j < kJoints; ++j) largest[j] = std::max(largest[j], std::abs(f[j]));
    return Joints<double>{planned.torque[0] + f[0], planned.torque[1] + f[1]};
  };
  integrate(tau, trajectory.start_time(), trajectory.end_time(), trajectory.samples.front().state);
  return largest;
}

TEST(Certificate, FeedbackPeaksBetweenTheInstantsAreTold) {
  const Trajectory& trajectory = reference_trajectory();
  const Joints<double> told = certificate_of(trajectory).closed_loop.feedback_torque;
  const Joints<double> expected = largest_feedback(trajectory);
  for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(told[j], expected[j], 0.05 * expected[j]);
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

// A pulse that lives in two of 430 intervals must not be stepped over, wherever it is.
TEST(Certificate, APulseInASingleRowIsSeen) {
  for (const std::size_t row : {1u, 57u, 143u, 333u}) {
    Trajectory trajectory = reference_trajectory();
    trajectory.samples[row].torque[0] += 0.05;
    trajectory.samples[row].torque[1] += 0.05;
    const FixedSteps expected = by_fixed_steps(trajectory, {}, {});
    const RolloutErrors errors = certificate_of(trajectory).open_loop;
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(errors.motor[j], expected.motor[j], 3e-7) << row;
  }
}

// At rest nothing limits the steps but the rows: a pulse must be found all the same.
TEST(Certificate, APulseInARestIsSeen) {
  for (const double size : {0.008, 0.5}) {  // without and with corners that force a stop
    Trajectory trajectory = resting({0.5, 0.3}, 0.05);
    trajectory.samples[40].torque[1] += size;
    const FixedSteps expected = by_fixed_steps(trajectory, {}, {});
    const RolloutErrors errors = certificate_of(trajectory).open_loop;
    EXPECT_GT(expected.motor[1], 1e-6);
    EXPECT_NEAR(errors.motor[1], expected.motor[1], 0.02 * expected.motor[1])
        << size;  // e^(365 t) amplifies all errors
  }
}

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

// Half a count of the coarse encoder, by which the arm may begin off the plan, is two of the fine one.
TEST(Certificate, EncodersMayDiffer) {
  for (const std::size_t coarse : {0u, 1u}) {
    Parameters p = robot();
    p.encoder.link_counts[coarse] /= 4;
    const Certificate c = certify(p, Limits::of(p), resting({0.3, 0.2}, 0.05));
    EXPECT_TRUE(c.certified) << (c.failures.empty() ? "" : c.failures.front());
  }
}

// ---- rest, and the upright ----

TEST(Amplification, BandIsWhereTheCompleteLawFalls) {
  EXPECT_EQ(FrictionLaw::of(robot(), 0).unstable_band(), 0);
  const FrictionLaw second = FrictionLaw::of(robot(), 1);
  const double band = second.unstable_band();
  EXPECT_NEAR(band, 5.08e-4, 1e-6);
  EXPECT_NEAR(second.torque(band), -1.77e-3, 1e-5);
}

// det(s I - A) is zero at the largest real eigenvalue and positive beyond it.
TEST(Amplification, GrowthRateIsTheLargestRealEigenvalueOfTheCompleteArm) {
  for (const Joints<double> q : {Joints<double>{pi, 0}, {2.0, 0.3}, {1.8, -1.0}, {0.2, pi}, {0.3, 0.4}}) {
    const Eigen::MatrixXd a = linearised_arm(q);
    const auto characteristic = [&](double s) {
      return (s * Eigen::MatrixXd::Identity(kStates, kStates) - a).partialPivLu().determinant();
    };
    const double rate = gravity_growth_rate(robot(), q);
    if (rate > 0) {
      EXPECT_LT(characteristic(rate - 1e-4), 0) << q[0] << ", " << q[1];
    }
    for (double s = rate + 1e-4; s < 1e3; s *= 1.05) EXPECT_GT(characteristic(s), 0) << q[0] << ", " << q[1];
  }
  EXPECT_NEAR(gravity_growth_rate(robot(), {pi, 0}), 4.2, 0.05);
  EXPECT_EQ(gravity_growth_rate(robot(), {0.3, 0.4}), 0);
}

// At q with motors that move out of their bands, for `duration`.
Trajectory moving_at(const Joints<double>& q, double duration) {
  Trajectory trajectory = resting(q, duration);
  all([](Sample& row) { row.state.dtheta = {0.01, 0.01}; })(trajectory.samples);
  return trajectory;
}

TEST(Amplification, LongRestsOfMotorTwoAndLongStaysUprightAreStretches) {
  EXPECT_THAT(stretches_of_amplification(robot(), resting({0.3, 0.2}, 0.09)), IsEmpty());
  const std::vector<Stretch> rest = stretches_of_amplification(robot(), resting({0.3, 0.2}, 0.3));
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].from, 0);
  EXPECT_EQ(rest[0].to, 0.3);
  EXPECT_EQ(rest[0].joint, 2);
  EXPECT_THAT(rest[0].why, HasSubstr("motor 2 rests from 0.000 s"));
  EXPECT_THAT(stretches_of_amplification(robot(), moving_at({pi, 0}, 0.5)), IsEmpty());
  EXPECT_THAT(stretches_of_amplification(robot(), moving_at({1.0, 0}, 10.0)), IsEmpty());
}

// 4.2/s upright: e^3 every 0.72 s.
TEST(Amplification, GravityAsksForARunOfItsOwnWheneverItHasAmplifiedTwentyfold) {
  const std::vector<Stretch> upright = stretches_of_amplification(robot(), moving_at({pi, 0}, 2.0));
  ASSERT_EQ(upright.size(), 2u);
  EXPECT_NEAR(upright[0].from, 3 / 4.2, 0.02);
  EXPECT_EQ(upright[0].to, upright[0].from);
  EXPECT_NEAR(upright[1].to, 2 * upright[0].to, 0.02);
  EXPECT_THAT(upright[1].why, HasSubstr("upright"));
}

TEST(Amplification, EveryRestIsAStretchOfItsOwn) {
  Trajectory trajectory = resting({0.3, 0.2}, 1);
  for (std::size_t k = 200; k < 400; ++k) trajectory.samples[k].state.dtheta[1] = 0.1;
  for (std::size_t k = 450; k < 600; ++k) trajectory.samples[k].state.dtheta[1] = 0.1;  // 0.05 s after the one before
  const std::vector<Stretch> rests = stretches_of_amplification(robot(), trajectory);
  ASSERT_EQ(rests.size(), 2u);
  EXPECT_NEAR(rests[0].to, 0.199, 1e-12);
  EXPECT_NEAR(rests[1].from, 0.6, 1e-12);
  EXPECT_NEAR(rests[1].to, 1, 1e-12);
}

void append(Trajectory& trajectory, const Trajectory& more) {
  const double from = trajectory.end_time();
  for (std::size_t k = 1; k < more.samples.size(); ++k) {
    trajectory.samples.push_back(more.samples[k]);
    trajectory.samples.back().time += from;
  }
}

// What rests so long that no open-loop run across it is exact says nothing about what comes after: motor 1's torque is
// 0.2 % too large there, which is refused as it is without the rest.
TEST(Certificate, ALongRestExcusesNothingElse) {
  for (const double torque : {1.0, 1.002}) {
    Trajectory rest_first = resting({0.1, -0.2}, 0.11), motion = reference_trajectory();
    all([&](Sample& row) { row.torque[0] *= torque; })(motion.samples);
    motion.samples.front().torque = rest_first.samples.back().torque;
    append(rest_first, motion);
    const Certificate c = certificate_of(rest_first);
    ASSERT_EQ(c.open_loop.stretches.size(), 1u);
    EXPECT_EQ(c.certified, torque == 1) << testing::PrintToString(c.failures);
    if (torque != 1) {
      EXPECT_THAT(c.failures, testing::Contains(HasSubstr("open loop: link")));
    }
  }
}

// Motor 2 stands still while link 1 swings: tau2 is what its spring pulls with, tau1 is smooth.
Trajectory swing_with_motor_two_at_rest(double duration) {
  Trajectory trajectory;
  State<double> x = rest_at(robot(), {0.1, -0.2});
  const auto torque = [](double t, const State<double>& at) {
    return Joints<double>{smooth_torque(t)[0], spring_torque(robot(), at.q, at.theta)[1]};
  };
  trajectory.samples.push_back({0, x, torque(0, x)});
  const double still = x.theta[1];
  constexpr double kStep = 1e-6;  // [s] motor 1 passes through the friction step in 60 of these
  for (int k = 1; k * kStep <= duration + 1e-9; ++k) {
    x = runge_kutta_step(torque, (k - 1) * kStep, x, kStep);
    x.theta[1] = still;
    x.dtheta[1] = 0;
    if (k % 1000 == 0) trajectory.samples.push_back({k * kStep, x, torque(k * kStep, x)});
  }
  return trajectory;
}

TEST(Certificate, WhileOneMotorRestsTheOtherIsStillInOpenLoop) {
  for (const double torque : {1.0, 1.002}) {
    Trajectory trajectory = swing_with_motor_two_at_rest(0.2);
    all([&](Sample& row) { row.torque[0] *= torque; })(trajectory.samples);
    const Certificate c = certificate_of(trajectory);
    ASSERT_EQ(c.open_loop.stretches.size(), 1u);
    EXPECT_EQ(c.open_loop.stretches[0].to, trajectory.end_time());
    EXPECT_EQ(c.certified, torque == 1) << testing::PrintToString(c.failures);
    if (torque != 1) {
      EXPECT_THAT(c.failures, testing::Contains(HasSubstr("open loop: link 1")));
    }
  }
}

TEST(Certificate, RestOfMotorTwoIsCertifiedInClosedLoop) {
  Trajectory trajectory = resting({0.5, 0.3}, 0.3);
  trajectory.samples.front().state.dtheta[1] += 1e-9;  // the seed of the instability
  const Certificate c = certificate_of(trajectory);
  EXPECT_THAT(c.failures, IsEmpty());
  EXPECT_THAT(c.open_loop.why_not_in_one_run(), HasSubstr("motor 2 rests"));
  EXPECT_TRUE(c.residual.evaluated);
  EXPECT_EQ(c.residual.window, 1.0);
  // Feedback bounds what open loop lets run away: friction pushes at most 1.77e-3 N m around rest.
  EXPECT_LT(c.residual.link_vibration[1], 2e-4);
  EXPECT_GT(c.residual.open_loop_drift[1], 5e-4);
}

// Without the dither motor 2 leaves its rest for a limit cycle of 1.03 counts, from whatever start that is not exactly
// the rest.
TEST(Certificate, ARestThatTheExecutorHoldsIsCertifiedHoweverLong) {
  for (const Joints<double> q : {Joints<double>{0, 0}, {0.5, 0.3}}) {
    for (const double off : {1e-12, 1e-9}) {
      Trajectory trajectory = resting(q, 1);
      trajectory.samples.front().state.theta[1] += off;
      const Certificate c = certificate_of(trajectory);
      EXPECT_THAT(c.failures, IsEmpty()) << q[0] << ", " << off;
      EXPECT_LT(c.closed_loop.max_link(), 0.2 * c.tolerance);  // 0.06, of the swing
      EXPECT_LT(c.closed_loop.perturbed.max_link(), 0.6 * c.tolerance);
    }
  }
}

// ---- from elsewhere than exactly the start ----

// A drive that cannot give what gravity takes: on the way the arm is rolled out with the executor's law, of which that
// is a part, and the links fall.
TEST(Certificate, ARestOnTheWayIsHeldAsTheExecutorDoes) {
  Parameters weak = robot();
  const Trajectory trajectory = resting({0.5, 0.3}, 0.1);
  EXPECT_LT(roll_out_perturbed(weak, trajectory).max_link(), 0.6 * exactness_tolerance(weak));
  weak.drive.peak_torque[0] = 0.5 * trajectory.samples.front().torque[0];
  EXPECT_GT(roll_out_perturbed(weak, trajectory).max_link(), 10 * exactness_tolerance(weak));
}

// The executor holds the arm from each of the five ends.
TEST(Certificate, AfterTheEndTheWorstOfAllEndsCounts) {
  const Trajectory trajectory = resting({1.2, -0.8}, 0.02);
  const Sample &first = trajectory.samples.front(), &last = trajectory.samples.back();
  Joints<double> worst{};
  for (const Joints<double> signs : {Joints<double>{1, 1}, {1, -1}, {-1, 1}, {-1, -1}, {1e-3, 1e-3}}) {
    Rollout arm(robot(), Limits{}, Accuracy::of_predictions());
    arm.limit_step(longest_step(trajectory));
    arm.start(0, moved(first.state, {signs[0] / 2, signs[1] / 2}), Drive::closed_loop(trajectory, robot()));
    ASSERT_TRUE(arm.run(last.time, {}, torque_corners(trajectory, kCorner), {}));
    const Joints<double> after = deviation_at_rest(robot(), last, arm.state());
    for (std::size_t j = 0; j < kJoints; ++j) worst[j] = std::max(worst[j], after[j]);
  }
  const Perturbed told = roll_out_perturbed(robot(), trajectory);
  for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(told.after[j], worst[j], 1e-7);  // of 1e-4 that is judged
}

// Rows that are exact at rest would hide how far the arm comes off within a second of it.
TEST(Certificate, ARestIsJudgedTheSameHoweverExactItsRowsAre) {
  for (const double off : {0.0, 1e-12}) {
    for (const double duration : {0.2, 1.0}) {
      Trajectory trajectory = resting({0, 0}, duration);
      trajectory.samples.front().state.theta[0] += off;
      const Certificate c = certificate_of(trajectory);
      EXPECT_THAT(c.failures, IsEmpty()) << off << ", " << duration;
      EXPECT_GT(c.closed_loop.perturbed.link[0], 0.49 * c.tolerance);
    }
  }
}

// Friction that falls with speed up to where no dither within a tenth of a count can reach: nobody could hold it.
TEST(Certificate, AnArmThatWandersAfterTheEndIsRefused) {
  Parameters sticky = robot();
  sticky.friction.second_weight[1] *= 4;
  const Certificate c = certify(sticky, robot_limits(), resting({0, 0}, 0.02));
  EXPECT_FALSE(c.certified);
  EXPECT_THAT(c.failures, ElementsAre(AllOf(HasSubstr("link 2"), HasSubstr("in the second after the end"))));
}

TEST(Certificate, FromHalfACountOffAgreesWithFixedSteps) {
  const Trajectory& trajectory = reference_trajectory();
  const Drive closed = Drive::closed_loop(trajectory, robot());
  Joints<double> worst{};
  for (const Joints<double> signs : {Joints<double>{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
    Interpolator plan(trajectory);
    const TorqueLaw tau = [&](double t, const State<double>& x) {
      const Sample planned = plan.at(t);
      const Joints<double> f = closed.feedback(planned.state, x);
      return Joints<double>{planned.torque[0] + f[0], planned.torque[1] + f[1]};
    };
    State<double> x = trajectory.samples.front().state;
    for (std::size_t j = 0; j < kJoints; ++j) {
      x.q[j] += signs[j] * pi / 65536;
      x.theta[j] += signs[j] * pi / 65536;
    }
    constexpr double kStep = 1e-6;  // [s]
    for (int k = 0; k < 430'000; ++k) {
      x = runge_kutta_step(tau, k * kStep, x, kStep);
      if (k % 1000 != 999) continue;
      const State<double> planned = trajectory.samples[static_cast<std::size_t>(k / 1000 + 1)].state;
      for (std::size_t j = 0; j < kJoints; ++j) worst[j] = std::max(worst[j], std::abs(x.q[j] - planned.q[j]));
    }
  }
  const Perturbed told = certificate_of(trajectory).closed_loop.perturbed;
  // A hundredth of what is judged.
  for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(told.link[j], std::max(worst[j], pi / 65536), 1e-6);
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

TEST(Certificate, RestOfMotorOneNeedsNoExcuse) {
  Trajectory trajectory = resting({0.5, 0.3}, 0.09);
  const Certificate c = certificate_of(trajectory);
  EXPECT_TRUE(c.certified);
  EXPECT_THAT(c.open_loop.stretches, IsEmpty());
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

TEST(Certificate, NamesTheLimitThatIsExceeded) {
  Limits limits = robot_limits();
  limits.spring_deflection[1] = 0.01;
  const Certificate c = certify(robot(), limits, reference_trajectory());
  EXPECT_FALSE(c.certified);
  EXPECT_THAT(c.failures, ElementsAre(HasSubstr("spring_deflection of joint 2 reaches")));
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
