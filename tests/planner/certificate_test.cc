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
#include "planner/certificate/limits.h"
#include "planner/certificate/perturbed.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/rollout.h"
#include "planner/certificate/tracking.h"
#include "planner/control/motor_feedback.h"

namespace fjr {
namespace {

using std::numbers::pi;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Parameters& robot() {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  return p;
}

Limits robot_limits() {
  Limits l;
  l.torque = robot().limits.torque;
  l.motor_velocity = robot().limits.motor_velocity;
  l.link_position = robot().limits.link_position;
  l.spring_deflection = robot().limits.spring_deflection;
  return l;
}

// ---- an independent integrator: classical Runge-Kutta, small fixed steps, smaller ones within the friction step ----

using Torque = std::function<Joints<double>(double, const State<double>&)>;

State<double> plus(const State<double>& x, double a, const State<double>& f) {
  State<double> r = x;
  for (int i = 0; i < kStates; ++i) r[i] += a * f[i];
  return r;
}

State<double> runge_kutta_step(const Torque& tau, double t, const State<double>& x, double h) {
  const auto f = [&](double at, const State<double>& y) { return dynamics(robot(), y, tau(at, y)); };
  const State<double> k1 = f(t, x), k2 = f(t + h / 2, plus(x, h / 2, k1)), k3 = f(t + h / 2, plus(x, h / 2, k2)),
                      k4 = f(t + h, plus(x, h, k3));
  return plus(plus(plus(plus(x, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
}

State<double> integrate(const Torque& tau, double from, double to, State<double> x) {
  constexpr double kCoarse = 4e-6, kFine = 2e-8, kNearRest = 3e-3;  // [s], [s], [rad/s]
  double t = from;
  while (t < to) {
    const double slowest = std::min(std::abs(x.dtheta[0]), std::abs(x.dtheta[1]));
    const double h = std::min(slowest < kNearRest ? kFine : kCoarse, to - t);
    x = runge_kutta_step(tau, t, x, h);
    t = to - t <= h ? to : t + h;
  }
  return x;
}

// ---- trajectories ----

Joints<double> smooth_torque(double t) {
  const double s = std::sin(2 * pi * t / 0.43);
  return {5 * s, 1.5 * s};
}

// Rows every `period` whose states follow exactly from their piecewise linear torque.
Trajectory exact_trajectory(const std::function<Joints<double>(double)>& torque, double duration, double period) {
  Trajectory trajectory;
  const int rows = static_cast<int>(std::lround(duration / period));
  Sample row{0, rest_at(robot(), {0.1, -0.2}), torque(0)};
  trajectory.samples.push_back(row);
  for (int k = 1; k <= rows; ++k) {
    const Sample next{k * period, {}, torque(k * period)};
    const auto linear = [&](double t, const State<double>&) {
      const double s = (t - row.time) / (next.time - row.time);
      return Joints<double>{row.torque[0] + s * (next.torque[0] - row.torque[0]),
                            row.torque[1] + s * (next.torque[1] - row.torque[1])};
    };
    const State<double> x = integrate(linear, row.time, next.time, row.state);
    row = next;
    row.state = x;
    trajectory.samples.push_back(row);
  }
  return trajectory;
}

const Trajectory& reference_trajectory() {
  static const Trajectory trajectory = exact_trajectory(smooth_torque, 0.43, 1e-3);
  return trajectory;
}

// At rest at q for a while, with exactly the right torque.
Trajectory resting(const Joints<double>& q, double duration) {
  Trajectory trajectory;
  const int rows = static_cast<int>(std::lround(duration / 1e-3));
  for (int k = 0; k <= rows; ++k) {
    trajectory.samples.push_back({k * 1e-3, rest_at(robot(), q), gravity_torque(robot(), q)});
  }
  return trajectory;
}

Certificate certificate_of(const Trajectory& trajectory) { return certify(robot(), robot_limits(), trajectory); }

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
  const Torque tau = [&](double t, const State<double>& x) {
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
  const Torque tau = [&](double t, const State<double>& x) {
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

// ---- rest, and the upright ----

TEST(Amplification, BandIsWhereTheCompleteLawFalls) {
  EXPECT_EQ(FrictionLaw::of(robot(), 0).unstable_band(), 0);
  const FrictionLaw second = FrictionLaw::of(robot(), 1);
  const double band = second.unstable_band();
  EXPECT_NEAR(band, 5.08e-4, 1e-6);
  EXPECT_NEAR(second.torque(band), -1.77e-3, 1e-5);
}

// Jacobian at rest of the complete arm without the nonlinear friction, by central differences.
Eigen::MatrixXd linearised_arm(const Joints<double>& q) {
  const State<double> rest = rest_at(robot(), q);
  const Joints<double> u = gravity_torque(robot(), q);
  Eigen::MatrixXd a(kStates, kStates);
  for (int i = 0; i < kStates; ++i) {
    State<double> up = rest, down = rest;
    up[i] += 1e-5;
    down[i] -= 1e-5;
    const State<double> f1 = compensated_dynamics(robot(), up, u), f0 = compensated_dynamics(robot(), down, u);
    for (int k = 0; k < kStates; ++k) a(k, i) = (f1[k] - f0[k]) / 2e-5;
  }
  return a;
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

// Off by so many counts of the link encoders, the motors with the links.
State<double> moved(State<double> x, const Joints<double>& counts) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    x.q[j] += counts[j] * count_angle(robot().encoder.link_counts[j]);
    x.theta[j] += counts[j] * count_angle(robot().encoder.link_counts[j]);
  }
  return x;
}

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

// With ticks, counts of all encoders, and friction that falls with speed at rest. The seed is that of the instability:
// without the dither link 2 comes off by 2.5 to 3.4 counts. The swing itself takes 0.07.
TEST(Feedback, HoldsTheArmWithinATenthOfACount) {
  for (const Joints<double> q : {Joints<double>{0, 0}, {0.5, 0.3}, {1.2, -0.8}, {-2.0, 1.5}, {pi, 0}}) {
    const Sample goal{0, rest_at(robot(), q), gravity_torque(robot(), q)};
    for (const double sign : {-1.0, 1.0}) {
      State<double> beside = goal.state;
      beside.theta[1] += sign * 1e-9;
      const Joints<double> deviation = deviation_at_rest(robot(), goal, beside);
      for (const double d : deviation) EXPECT_LT(d, 0.1 * exactness_tolerance(robot())) << q[0] << ", " << q[1];
    }
  }
}

// Held for a second with what the encoders read beside the truth: the largest deviation, in counts of the link encoder.
double deviation_with(const Sample& goal, const MotorFeedback::Positions& beside) {
  Sample later = goal;
  later.time = 1;
  const Trajectory resting{{goal, later}, {}};
  TickController controller(robot(), resting);
  Rollout arm(robot(), Limits{}, Accuracy::of_predictions());
  arm.start(0, goal.state, Drive::holding(goal));
  double largest = 0;
  for (int k = 0; k < 1000; ++k) {
    MotorFeedback::Positions read{arm.state().theta, arm.state().q};
    for (std::size_t j = 0; j < kJoints; ++j) {
      read.theta[j] += beside.theta[j];
      read.q[j] += beside.q[j];
    }
    arm.hold(controller.command(k * kTick, read).torque);
    EXPECT_TRUE(arm.run((k + 1) * kTick, {}, {}, {}));
    for (std::size_t j = 0; j < kJoints; ++j) {
      largest = std::max(largest, std::abs(arm.state().q[j] - goal.state.q[j]) / exactness_tolerance(robot()));
    }
  }
  return largest;
}

// The zeros of the motors' encoders may be a count off, and those of the links' half a count: that is no more than
// where in a count the goal is.
TEST(Feedback, HoldsTheArmWithEncodersACountOff) {
  const Joints<double>& motors = robot().encoder.motor_counts;
  const double motor_1 = count_angle(motors[0]), motor_2 = count_angle(motors[1]), link = exactness_tolerance(robot());
  const Joints<double> q{1.2, -0.8};
  const Sample goal{0, rest_at(robot(), q), gravity_torque(robot(), q)};
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_LT(deviation_with(goal, {{sign * motor_1, 0}, {0, 0}}), 0.5) << sign;
    EXPECT_LT(deviation_with(goal, {{0, sign * motor_2}, {0, 0}}), 0.5) << sign;
    EXPECT_LT(deviation_with(goal, {{0, 0}, {sign * link / 2, 0}}), 0.5) << sign;
    EXPECT_LT(deviation_with(goal, {{0, 0}, {0, sign * link / 2}}), 0.5) << sign;
    // A whole one is pulled at for ever, and moves link 2, whose motor's friction yields, by what is wrong.
    EXPECT_LT(deviation_with(goal, {{0, 0}, {sign * link, 0}}), 0.5) << sign;
    EXPECT_LT(deviation_with(goal, {{0, 0}, {0, sign * link}}), 1) << sign;
  }
}

// A count off at first: it gets no worse, wherever in a count the goal is.
TEST(Feedback, HoldsTheArmFromACountOff) {
  for (double at = 0; at < 1; at += 0.125) {
    const double count = exactness_tolerance(robot());
    const Joints<double> q{0.5 + at * count, 0.3 + 2 * at * count};
    const Sample goal{0, rest_at(robot(), q), gravity_torque(robot(), q)};
    for (const Joints<double> off : {Joints<double>{0.5, -0.5}, {1, 1}, {1, -1}, {-1, 1}}) {
      const Joints<double> deviation = deviation_at_rest(robot(), goal, moved(goal.state, off));
      for (std::size_t j = 0; j < kJoints; ++j) {
        EXPECT_LT(deviation[j], (std::abs(off[j]) + 0.1) * count) << at << " " << off[0] << ", " << off[1];
      }
    }
  }
}

// Why it is stable: the slope of joint 2's law in the mean over a swing, which is what errors of its velocity see.
TEST(Dither, MakesFrictionRiseWithSpeedInTheMean) {
  const FrictionLaw law = FrictionLaw::of(robot(), 1);
  const auto mean_slope = [&](double bands) {
    double sum = 0;
    for (int k = 0; k < 1000; ++k) sum += law.slope(bands * law.unstable_band() * std::sin(2 * pi * (k + 0.5) / 1000));
    return sum / 1000;
  };
  EXPECT_LT(mean_slope(1.4), 0);
  EXPECT_GT(mean_slope(1.6), 0);
  EXPECT_GT(mean_slope(kDitherBands), 15);
  EXPECT_NEAR(Dither(robot(), 1, kTick).amplitude(), kDitherBands * law.unstable_band(), 1e-12);
  EXPECT_EQ(Dither(robot(), 0, kTick).amplitude(), 0);
}

TEST(Dither, BeginsAfterSomeTicksOfRestAndAddsNothingInTheMean) {
  Dither dither(robot(), 1, kTick), of_joint_1(robot(), 0, kTick);
  for (int k = 0; k < kDitherAfter; ++k) EXPECT_EQ(dither.next(0), 0);
  double sum = 0, largest = 0;
  for (int k = 0; k < kDitherPeriod; ++k) {
    const double torque = dither.next(0);
    sum += torque;
    largest = std::max(largest, std::abs(torque));
    EXPECT_EQ(of_joint_1.next(0), 0);
  }
  EXPECT_NEAR(sum, 0, 1e-12);
  EXPECT_GT(largest, 0.02);  // friction at 2e-3 rad/s
  EXPECT_LT(largest, 0.05);  // a hundredth of the torque limit
  EXPECT_EQ(dither.next(0.01), 0);
  EXPECT_EQ(dither.next(0), 0);
}

// Where the plan creeps, planned torque and dither are together the friction at planned and swing velocity, in the mean
// over a swing; the mean by the midpoint rule with 1000 points, eight a tick differ from it by less than 1e-6 N m.
TEST(Dither, MakesUpForTheFrictionOfAMotorThatCreeps) {
  const FrictionLaw law = FrictionLaw::of(robot(), 1);
  const double creep = 0.7 * law.unstable_band();  // [rad/s]
  Dither dither(robot(), 1, kTick);
  for (int k = 0; k < kDitherAfter; ++k) EXPECT_EQ(dither.next(creep), 0);
  double commanded = 0, friction = 0;
  for (int k = 0; k < kDitherPeriod; ++k) commanded += (law.torque(creep) + dither.next(creep)) / kDitherPeriod;
  for (int k = 0; k < 1000; ++k) {
    friction += law.torque(creep + dither.amplitude() * std::sin(2 * pi * (k + 0.5) / 1000)) / 1000;
  }
  EXPECT_NEAR(commanded, friction, 1e-6);
  EXPECT_GT(std::abs(friction - law.torque(creep)), 1e-3);  // what would be missing
}

// Torque of joint 2 for errors of this many counts of its motor and of its link.
double feedback_at(double motor_counts, double link_counts, const Joints<double>& planned_velocity = {1, 1}) {
  const Parameters& p = robot();
  MotorFeedback feedback(p, kTick);
  const MotorFeedback::Positions planned{{0, 0}, {0, 0}},
      measured{{0, -motor_counts * count_angle(p.encoder.motor_counts[1])},
               {0, -link_counts * count_angle(p.encoder.link_counts[1])}};
  feedback.start(planned.theta, measured.theta);
  return feedback.command(planned, planned_velocity, measured, {0, 0}).feedback[1];
}

// Two rests, between which motor 2 moves for 8 ms, and the same tick by tick.
TEST(Dither, OfAPlanIsThatOfItsTicks) {
  Trajectory trajectory = resting({0.3, 0.2}, 0.05);
  for (std::size_t k = 20; k < 28; ++k) trajectory.samples[k].state.dtheta[1] = 0.01;
  const PlannedDither planned(robot(), trajectory);
  Dither dither(robot(), 1, kTick);
  int steps = 0;
  for (int k = 0; k < 50; ++k) {
    const double torque = dither.next(trajectory.samples[static_cast<std::size_t>(k)].state.dtheta[1]);
    steps += k >= kDitherAfter && (k < 20 || k >= 28 + kDitherAfter);
    EXPECT_EQ(torque != 0, k >= kDitherAfter && (k < 20 || k >= 28 + kDitherAfter)) << k;
    for (const double share : {0.01, 0.5, 0.99}) {
      EXPECT_EQ(planned.at((k + share) * kTick), (Joints<double>{0, torque})) << k;
    }
  }
  EXPECT_EQ(planned.steps().size(), static_cast<std::size_t>(steps + 1));  // each tick of it, and the end of the first
  EXPECT_TRUE(std::is_sorted(planned.steps().begin(), planned.steps().end()));
}

TEST(Feedback, KnowsNothingWithinACountAndTheLinkTellsWithinTheMotors) {
  const Parameters& p = robot();
  const double motor = count_angle(p.encoder.motor_counts[1]), link = count_angle(p.encoder.link_counts[1]);
  EXPECT_EQ(feedback_at(0.49, 0.49), 0);
  EXPECT_NEAR(feedback_at(2, 0), p.feedback.position_gain[1] * 2 * motor, 1e-9);
  EXPECT_NEAR(feedback_at(0, 3), 0.5 * p.spring.stiffness[1] * 2.5 * link, 1e-9);
  EXPECT_NEAR(feedback_at(0, 100), 0.5 * p.spring.stiffness[1] * 0.5 * motor, 1e-9);
  EXPECT_NEAR(feedback_at(0, -100), -feedback_at(0, 100), 1e-15);
  EXPECT_EQ(feedback_at(1.4, 0.4, {0, 0}), 0);  // at rest
  EXPECT_NEAR(feedback_at(1.4, 20, {0, 0}), feedback_at(1.4, 20), 1e-15);
  EXPECT_NEAR(feedback_at(1.6, 0.4, {0, 0}), p.feedback.position_gain[1] * 2 * motor, 1e-9);
}

// The map over one tick of the linearised arm, of the filters, and of torques that come one tick late; friction is that
// of motors in motion, B. Spectral radius below 1: stable.
double spectral_radius_of_a_tick(const Parameters& p, const Joints<double>& q) {
  constexpr int kLast = kStates, kVelocity = kLast + 2, kTorque = kVelocity + 2, kSize = kTorque + 2;
  Eigen::MatrixXd continuous = Eigen::MatrixXd::Zero(kStates + 2, kStates + 2);
  continuous.topLeftCorner(kStates, kStates) = linearised_arm(q);
  for (int j = 0; j < kJoints; ++j) continuous(6 + j, kStates + j) = 1 / p.motor.inertia[static_cast<std::size_t>(j)];
  const Eigen::MatrixXd over_a_tick = (continuous * kTick).exp();
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(kSize, kSize);
  map.topLeftCorner(kStates, kStates) = over_a_tick.topLeftCorner(kStates, kStates);
  map.block(0, kTorque, kStates, 2) = over_a_tick.topRightCorner(kStates, 2);
  for (int j = 0; j < kJoints; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double keep = std::exp(-2 * pi * p.feedback.velocity_filter[i] * kTick);
    map(kLast + j, 4 + j) = 1;
    map(kVelocity + j, kVelocity + j) = keep;
    map(kVelocity + j, 4 + j) = (1 - keep) / kTick;
    map(kVelocity + j, kLast + j) = -(1 - keep) / kTick;
    map.row(kTorque + j) = -p.feedback.velocity_gain[i] * map.row(kVelocity + j);
    map(kTorque + j, 4 + j) -= p.feedback.position_gain[i];
  }
  return map.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(Feedback, OfMotorTwoIsStableUpToTenTimesItsGainsAndATickLate) {
  const auto radius = [](double factor) {
    Parameters p = robot();
    p.feedback.position_gain[1] *= factor;
    p.feedback.velocity_gain[1] *= factor;
    double largest = 0;
    for (const Joints<double> q : {Joints<double>{0, 0}, {1.2, -0.8}, {0.3, 1.57}, {0, 2.6}}) {
      largest = std::max(largest, spectral_radius_of_a_tick(p, q));
    }
    return largest;
  };
  EXPECT_LT(radius(1), 0.9996);  // the slowest is link 1's swing
  EXPECT_LT(radius(10), 1);
  EXPECT_GT(radius(40), 1);
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
    const Torque tau = [&](double t, const State<double>& x) {
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

// ---- limits between the rows ----

Sample row_at(double time, double q, double dq, double dtheta) {
  Sample row;
  row.time = time;
  row.state.q = {q, 0};
  row.state.dq = {dq, 0};
  row.state.theta = {q, 0};
  row.state.dtheta = {dtheta, 0};
  return row;
}

LimitCheck named(const std::vector<LimitCheck>& checks, const std::string& name, int joint) {
  for (const LimitCheck& check : checks) {
    if (check.name == name && check.joint == joint) return check;
  }
  ADD_FAILURE() << "no check of " << name;
  return {};
}

TEST(LimitChecks, FindExtremesBetweenTheRowsExactly) {
  // q: 0 -> 0 in 1 s with slopes 4 and -4: q = 4 s (1 - s), 1 at the middle. theta: slopes 0 and 0 over a step of 0.4:
  // velocity 6 * 0.4 s (1 - s), 0.6 at the middle; both rows' columns say 0.
  Trajectory trajectory;
  trajectory.samples = {row_at(0, 0, 4, 0), row_at(1, 0, -4, 0)};
  trajectory.samples[1].state.theta = {0.4, 0};
  Limits limits;
  limits.link_position = {0.99, kNoLimit};
  limits.motor_velocity = {0.6, kNoLimit};
  limits.spring_deflection = {2, kNoLimit};
  const std::vector<LimitCheck> checks = check_limits(robot(), limits, trajectory, {});
  ASSERT_EQ(checks.size(), 3u);
  EXPECT_NEAR(named(checks, "link_position", 1).reached, 1, 1e-12);
  EXPECT_NEAR(named(checks, "link_position", 1).time, 0.5, 1e-12);
  EXPECT_FALSE(named(checks, "link_position", 1).passed);
  EXPECT_THAT(violation(named(checks, "link_position", 1)),
              HasSubstr("link_position of joint 1 reaches 1 at 0.500000 s"));
  EXPECT_NEAR(named(checks, "motor_velocity", 1).reached, 0.6, 1e-12);
  EXPECT_TRUE(named(checks, "motor_velocity", 1).passed);  // on the limit, to rounding
  double sampled = 0;                                      // theta - q = 0.4 (3 s^2 - 2 s^3) - 4 s (1 - s)
  for (int i = 0; i <= 100000; ++i) {
    const double s = i * 1e-5;
    sampled = std::max(sampled, std::abs(0.4 * s * s * (3 - 2 * s) - 4 * s * (1 - s)));
  }
  EXPECT_NEAR(named(checks, "spring_deflection", 1).reached, sampled, 1e-8);
}

TEST(LimitChecks, AllowAMillionthAndNoMore) {
  Limits limits;
  limits.torque = {5, kNoLimit};
  for (const auto& [torque, passes] : {std::pair{5 * (1 + 0.9e-6), true}, {5 * (1 + 1.1e-6), false}, {-5.1, false}}) {
    Trajectory trajectory = resting({0, 0}, 0.01);
    trajectory.samples[4].torque[0] = torque;
    EXPECT_EQ(check_limits(robot(), limits, trajectory, {})[0].passed, passes) << torque;
  }
}

TEST(LimitChecks, ALimitOnlyTheRolloutExceedsIsRefused) {
  Trajectory trajectory = resting({0, 0}, 0.01);
  Limits limits;
  limits.motor_velocity = {6, 8};
  Comparison rollout;
  rollout.peaks.motor_velocity = {6.005, 8.009};
  const std::vector<LimitCheck> checks = check_limits(robot(), limits, trajectory, rollout);
  EXPECT_TRUE(checks[0].passed);   // 0.1 % of 6 is 0.006
  EXPECT_FALSE(checks[1].passed);  // 0.1 % of 8 is 0.008
  EXPECT_THAT(violation(checks[1]), HasSubstr("closed-loop rollout"));
  Comparison brief;
  brief.events = {{0.005, &Quantities::infos[1], 1}};
  EXPECT_FALSE(check_limits(robot(), limits, trajectory, brief)[0].passed);
}

TEST(LimitChecks, TorqueRateIsThatOfTheCompensatedTorque) {
  // u = 3 t + 1 for joint 1 while its motor reverses: tau jumps by the friction, in a pair of rows.
  const FrictionLaw law = FrictionLaw::of(robot(), 0);
  Trajectory trajectory;
  for (const double t : {0.0, 1e-3, 2e-3, 2.4e-3 - 5e-7, 2.4e-3 + 5e-7, 3e-3, 4e-3}) {
    Sample row;
    row.time = t;
    row.state.dtheta[0] = 20 * (t - 2.4e-3);
    row.torque[0] = 3 * t + 1 + law.nonlinear(row.state.dtheta[0]);
    trajectory.samples.push_back(row);
  }
  Limits limits;
  limits.torque_rate = {3, kNoLimit};
  const std::vector<LimitCheck> checks = check_limits(robot(), limits, trajectory, {});
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_NEAR(checks[0].reached, 3, 1e-9);
  EXPECT_TRUE(checks[0].passed);
  trajectory.samples[5].torque[0] += 1e-3;
  EXPECT_NEAR(check_limits(robot(), limits, trajectory, {})[0].reached, 3 + 1e-3 / (0.6e-3 - 5e-7), 1e-6);
}

TEST(LimitChecks, TipSpeedIsThatOfBothLinks) {
  Trajectory trajectory;
  trajectory.samples = {row_at(0, 0, 2, 0), row_at(0.1, 0.2, 2, 0)};
  Limits limits;
  limits.tip_speed = 1.2;
  const std::vector<LimitCheck> checks = check_limits(robot(), limits, trajectory, {});
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_EQ(checks[0].joint, 0);
  EXPECT_NEAR(checks[0].reached, 2 * (0.345 + 0.305), 1e-9);  // stretched out, turning about joint 1
  EXPECT_FALSE(checks[0].passed);
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
  const Torque tau = [&](double t, const State<double>&) { return plan.torque_at(t); };
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

// ---- interpolation ----

TEST(Interpolator, FollowsACubicExactlyAndItsTorqueLinearly) {
  const auto cubic = [](double t) { return 1 + t * (2 + t * (-3 + t * 4)); };
  const auto slope = [](double t) { return 2 + t * (-6 + t * 12); };
  Trajectory trajectory;
  for (const double t : {0.0, 0.3, 0.300001, 1.0}) {
    Sample row;
    row.time = t;
    row.state = {{cubic(t), 0}, {slope(t), 0}, {0, -cubic(t)}, {0, -slope(t)}};
    row.torque = {t < 0.3000005 ? t : 7 - t, 2 * t};
    trajectory.samples.push_back(row);
  }
  Interpolator at(trajectory);
  for (const double t : {0.9, 0.0, 0.1, 0.29, 0.3, 0.3000005, 0.31, 1.0, 0.5}) {  // in any order
    const Sample s = at.at(t);
    EXPECT_NEAR(s.state.q[0], cubic(t), 1e-14);
    EXPECT_NEAR(s.state.dq[0], slope(t), 1e-9);  // cancellation within the jump: 1e-16 / 1e-6
    EXPECT_NEAR(s.state.theta[1], -cubic(t), 1e-14);
    EXPECT_NEAR(s.state.dtheta[1], -slope(t), 1e-9);
    EXPECT_NEAR(s.torque[1], 2 * t, 1e-14);
    EXPECT_EQ(at.torque_at(t), s.torque);
  }
  EXPECT_NEAR(at.torque_at(0.15)[0], 0.15, 1e-15);
  EXPECT_NEAR(at.torque_at(0.7)[0], 6.3, 1e-12);
  EXPECT_EQ(at.at(-1).state.q[0], 1);
  EXPECT_NEAR(at.at(2).state.q[0], cubic(1), 1e-15);
  EXPECT_EQ(at.torque_at(2)[0], 6);
}

TEST(Interpolator, MeansAreExactOverJumpsAndBeyondTheEnds) {
  Trajectory trajectory;
  for (const auto& [time, tau] : {std::pair{1.0, 0.0}, {2.0, 2.0}, {2.000001, -2.0}, {3.0, 0.0}}) {
    Sample row;
    row.time = time;
    row.torque = {tau, 5};
    trajectory.samples.push_back(row);
  }
  Interpolator at(trajectory);
  EXPECT_NEAR(at.mean_torque(1, 2)[0], 1, 1e-12);
  EXPECT_NEAR(at.mean_torque(1, 3)[0], 0, 1e-6);
  EXPECT_NEAR(at.mean_torque(1.25, 1.75)[0], 1, 1e-12);
  EXPECT_NEAR(at.mean_torque(1.5, 2.5)[0], (0.75 - 0.75) / 1.0, 2e-6);
  EXPECT_NEAR(at.mean_torque(2.5, 4.5)[0], -0.125, 1e-6);  // zero after the end
  EXPECT_NEAR(at.mean_torque(0, 2)[0], 0.5, 1e-12);        // zero before the start
  EXPECT_NEAR(at.mean_torque(5, 6)[0], 0, 1e-15);
  EXPECT_NEAR(at.mean_torque(2.7, 2.7)[0], at.torque_at(2.7)[0], 1e-15);
  EXPECT_NEAR(at.mean_torque(0, 6)[1], 5, 1e-12);
}

// ---- the executor's law ----

TEST(Tracking, CommandsThePlannedMeanWhenTheArmIsWhereItShouldBe) {
  Parameters fine = robot();
  fine.encoder.motor_counts = {1e9, 1e9};
  const Trajectory& plan = reference_trajectory();
  TickController controller(fine, plan);
  Interpolator at(plan);
  for (int k = 0; k < 430; ++k) {
    const double t = k * kTick;
    const TickController::Command command = controller.command(t, {at.at(t).state.theta, at.at(t).state.q});
    const Joints<double> mean = at.mean_torque(t, t + kTick);
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(command.torque[j], mean[j], 1e-4);
    EXPECT_FALSE(command.saturated);
  }
}

TEST(Tracking, IsLimitedByTheEncoderAndNotByTheFilter) {
  const Tracking t = certificate_of(reference_trajectory()).tracking;
  // Half a count of the motor encoders, 0.79e-3 and 1.57e-3 rad: what feedback does not see.
  EXPECT_LT(t.link_error[0], 0.79e-3);
  EXPECT_LT(t.link_error[1], 1.57e-3);
  EXPECT_GT(t.link_error[1], 1e-6);
  EXPECT_LE(t.link_error_rms[1], t.link_error[1]);
  // A count (1.57e-3 and 3.14e-3 rad) through the gains and the filter: about 0.6 and 0.3 N m.
  EXPECT_LT(t.feedback_torque[0], 1.0);
  EXPECT_LT(t.feedback_torque[1], 0.6);
  EXPECT_FALSE(t.saturated);
}

TEST(Tracking, ClampsAtTheDrivesPeakAndSaysSo) {
  TickController controller(robot(), reference_trajectory());
  const TickController::Command command = controller.command(0, {{3, -3}, {0, 0}});
  EXPECT_THAT(command.torque, ElementsAre(-14.4, 6));
  EXPECT_TRUE(command.saturated);
}

}  // namespace
}  // namespace fjr
