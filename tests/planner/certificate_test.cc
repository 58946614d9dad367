// Certificates against what must be true: trajectories that are exact by construction pass, every falsified column is
// refused with its reason, and the figures agree with an integration by fixed steps that shares no code with CVODE.
#include "planner/certificate/certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "planner/certificate/comparison.h"
#include "planner/certificate/tracking.h"
#include "planner/control/motor_feedback.h"
#include "support/exact_trajectories.h"

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

void zigzag(Rows& rows) {
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k].state.dq[1] += k % 2 == 0 ? 0.03 : -0.03;
}

const Forgery kForgeries[] = {
    {"OneTorqueRow", [](Rows& r) { r[100].torque[1] += 0.1; }, "open loop: link 2"},
    {"TorqueScaled", in_every_row([](Sample& row) { row.torque[0] *= 1.002; }), "open loop: link"},
    {"TorqueMirrored", in_every_row([](Sample& row) { row.torque[1] *= -1; }), "feedback torque of joint 2"},
    {"LinkRowShifted", [](Rows& r) { r[300].state.q[0] += 1.5e-4; }, "closed loop: link 1"},
    {"LastLinkRowShifted", [](Rows& r) { r.back().state.q[1] += 1.5e-4; }, "link 2"},
    {"StartShifted", [](Rows& r) { r.front().state.theta[1] += 2e-3; }, "link 2"},
    {"LinkVelocityScaled", in_every_row([](Sample& row) { row.state.dq[0] *= 1.05; }), "dq1 disagrees"},
    {"OneLinkVelocityRow", [](Rows& r) { r[100].state.dq[1] += 0.03; }, "dq2 disagrees"},
    {"LinkVelocityZigzag", zigzag, "the velocity of link 2"},
    {"MotorVelocityScaled", in_every_row([](Sample& row) { row.state.dtheta[0] *= 1.02; }), "dtheta1 disagrees"},
    {"MotorVelocityMissing", in_every_row([](Sample& row) { row.state.dtheta[1] = 0; }), "dtheta2 disagrees"},
    {"MotorPositionsShifted", in_every_row([](Sample& row) { row.state.theta[0] += 5e-3; }), "closed loop"},
    {"NotFinite", [](Rows& r) { r[7].torque[0] = kNaN; }, "row 8 holds a value that is not finite"},
    {"TimeBackwards", [](Rows& r) { r[7].time = r[6].time; }, "time does not increase at row 8"},
    {"TimeHardlyIncreases", [](Rows& r) { r[7].time = r[6].time + 9e-10; },
     "row 8 at 0.006000001 s is 9.0e-10 s after the row before it, at least 1e-09 s are needed"},
    {"OneRow", [](Rows& r) { r.resize(1); }, "fewer than two rows"},
    {"TooLong", [](Rows& r) { r.back().time = 1e6; }, "the trajectory takes 1e+06 s"},
    // At 2^20 s rows 1 ns apart are the same instant to an integrator, and at 2^30 s its clock drifts.
    {"ClockFarFromZero", in_every_row([](Sample& row) { row.time += 1048576; }),
     "the trajectory begins at 1.04858e+06 s"},
    {"HugeTorque", in_every_row([](Sample& row) { row.torque[0] = 1e300; }), "open loop: "},
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
  in_every_row([](Sample& row) { row.torque = {1.03 * row.torque[0], 0.95 * row.torque[1]}; })(trajectory.samples);
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

// Half a count of the coarse encoder, by which the arm may begin off the plan, is two of the fine one.
TEST(Certificate, EncodersMayDiffer) {
  for (const std::size_t coarse : {0u, 1u}) {
    Parameters p = robot();
    p.encoder.link_counts[coarse] /= 4;
    const Certificate c = certify(p, Limits::of(p), resting({0.3, 0.2}, 0.05));
    EXPECT_TRUE(c.certified) << (c.failures.empty() ? "" : c.failures.front());
  }
}

TEST(Certificate, NamesTheLimitThatIsExceeded) {
  Limits limits = robot_limits();
  limits.spring_deflection[1] = 0.01;
  const Certificate c = certify(robot(), limits, reference_trajectory());
  EXPECT_FALSE(c.certified);
  EXPECT_THAT(c.failures, ElementsAre(HasSubstr("spring_deflection of joint 2 reaches")));
}

}  // namespace
}  // namespace fjr
