// Proofs against what must be true: what is exact by construction is proven, what misses a bound by 1e-9 never is, and
// integrations that share no code with the enclosure lie inside of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "planner/certificate/proof/arm_flow.h"
#include "planner/certificate/proof/prove.h"
#include "planner/certificate/proof/reach.h"
#include "planner/certificate/rollout.h"
#include "planner/certificate/thresholds.h"
#include "support/exact_trajectories.h"

namespace fjr {
namespace {

using enclosure::Ball;
using testing::HasSubstr;
using testing::IsEmpty;

Proof proof_of(const Trajectory& trajectory) { return prove(robot(), robot_limits(), trajectory); }

// The motion of the exact arm under the rows' torque, by Runge-Kutta in small fixed steps, at every row.
std::vector<State<double>> integrated(const Trajectory& trajectory) {
  std::vector<State<double>> states{trajectory.samples.front().state};
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    const Sample &a = trajectory.samples[k], &b = trajectory.samples[k + 1];
    const auto torque = [&](double t, const State<double>&) {
      const double s = (t - a.time) / (b.time - a.time);
      return Joints<double>{a.torque[0] + s * (b.torque[0] - a.torque[0]),
                            a.torque[1] + s * (b.torque[1] - a.torque[1])};
    };
    states.push_back(integrate(torque, a.time, b.time, states.back()));
  }
  return states;
}

// Link 1 of the plan bulges smoothly by `height` in the middle, positions and velocities alike.
Trajectory bulging(double height) {
  Trajectory trajectory = reference_trajectory();
  const double duration = trajectory.end_time(), rate = 2 * std::numbers::pi / duration;
  for (Sample& row : trajectory.samples) {
    row.state.q[0] += height / 2 * (1 - std::cos(rate * row.time));
    row.state.dq[0] += height / 2 * rate * std::sin(rate * row.time);
  }
  return trajectory;
}

TEST(Proof, WhatIsExactByConstructionIsProven) {
  const Proof proof = proof_of(reference_trajectory());
  EXPECT_THAT(proof.reason, IsEmpty());
  EXPECT_TRUE(proof.proven);
  EXPECT_DOUBLE_EQ(proof.until, 0.43);
  EXPECT_TRUE(proof.open_loop.proven && proof.closed_loop.proven);
  EXPECT_LT(proof.open_loop.width, 1e-9);  // five digits more than what is allowed
  EXPECT_EQ(proof.limits.size(), 8U);
}

// Bounds are not below what integrators find, and at most 1e-6 rad above.
TEST(Proof, BoundsHoldWhatTheCertificateFinds) {
  const Trajectory trajectory = bulging(0.5 * exactness_tolerance(robot()));
  const Certificate c = certificate_of(trajectory);
  const Proof proof = proof_of(trajectory);
  ASSERT_TRUE(proof.proven) << proof.reason;
  constexpr double kIntegrator = 1e-8;  // [rad] error of the certificate's
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_GE(proof.open_loop.link[j], c.open_loop.link[j] - kIntegrator);
    EXPECT_LE(proof.open_loop.link[j], c.open_loop.link[j] + 1e-6);
    EXPECT_GE(proof.closed_loop.link[j], c.closed_loop.link[j] - kIntegrator);
    EXPECT_LE(proof.closed_loop.link[j], c.closed_loop.link[j] + 1e-6);
    EXPECT_NEAR(proof.closed_loop.feedback_torque[j], c.closed_loop.feedback_torque[j], 1e-5);
  }
  for (const LimitBound& bound : proof.limits) {
    const auto check = std::find_if(c.limits.begin(), c.limits.end(), [&](const LimitCheck& l) {
      return l.name == bound.name && l.joint == bound.joint;
    });
    ASSERT_NE(check, c.limits.end());
    EXPECT_GE(bound.published, check->reached * (1 - 1e-12)) << bound.name;
    EXPECT_NEAR(bound.published, check->reached, 2e-6 * check->limit) << bound.name;
    if (!bound.rollout) continue;
    EXPECT_NEAR(*bound.rollout, check->rollout, 1e-5 * check->limit) << bound.name;
  }
}

TEST(Proof, AnErrorOneNanoradianAboveWhatIsAllowedIsNeverProven) {
  const Trajectory trajectory = bulging(0.5 * exactness_tolerance(robot()));
  const std::vector<State<double>> exact = integrated(trajectory);
  double error = 0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    error = std::max(error, std::abs(exact[k].q[0] - trajectory.samples[k].state.q[0]));
  }
  Claims claims = Claims::of(robot(), robot_limits());
  claims.link = error - 1e-9;
  const Proof refused = prove(robot(), trajectory, claims);
  EXPECT_FALSE(refused.proven);
  EXPECT_FALSE(refused.open_loop.proven);
  EXPECT_THAT(refused.reason, HasSubstr("not proven from t = 0.2"));
  EXPECT_THAT(refused.open_loop.reason, HasSubstr("link 1 may be"));
  claims.link = error + 1e-7;  // the largest error may be between rows, and open and closed loop differ a little
  EXPECT_TRUE(prove(robot(), trajectory, claims).proven);
}

// Of the rows, and of the motion in closed loop, which is the same here but for 1e-10 rad.
TEST(Proof, ALimitJustBelowWhatIsReachedIsNeverProven) {
  Trajectory trajectory = reference_trajectory();
  trajectory.samples.resize(120);
  const std::vector<State<double>> exact = integrated(trajectory);
  Limits rows = Limits::all(0), motion = Limits::all(0);
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const Sample& row = trajectory.samples[k];
    const Joints<double> no_rate{};
    const auto every = [](const QuantityInfo&) { return true; };
    raise(rows, {robot(), row.state, row.torque, no_rate}, every);
    raise(motion, {robot(), exact[k], row.torque, no_rate}, every);
  }
  Claims possible = Claims::of(robot(), robot_limits());
  for (const LimitName& name : kLimitNames) {
    if (name.quantity->bound == BoundOn::kControl) continue;
    name.in(possible.published) = name.in(rows) * (1 + 1e-4);  // between rows there is a little more
    if (name.quantity->in_rollout != InRollout::kOfPlan) name.in(possible.rollout) = name.in(motion) * (1 + 1e-4);
  }
  EXPECT_TRUE(prove(robot(), trajectory, possible).proven);
  for (const LimitName& name : kLimitNames) {
    if (name.quantity->bound == BoundOn::kControl) continue;
    Claims claims = possible;
    name.in(claims.published) = name.in(rows)-1e-9;
    const Proof published = prove(robot(), trajectory, claims);
    EXPECT_FALSE(published.proven) << name.quantity->name;
    EXPECT_THAT(published.reason, HasSubstr(name.quantity->name));
    if (name.quantity->in_rollout == InRollout::kOfPlan) continue;
    claims = possible;
    name.in(claims.rollout) = name.in(motion)-1e-9;
    EXPECT_FALSE(prove(robot(), trajectory, claims).proven) << name.quantity->name;
  }
}

TEST(Proof, ATorqueThatIsATenthOfAPercentOffIsNotProven) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    Trajectory trajectory = reference_trajectory();
    for (Sample& row : trajectory.samples) row.torque[j] *= 1.001;
    const Proof proof = proof_of(trajectory);
    EXPECT_FALSE(proof.proven);
    EXPECT_THAT(proof.reason, HasSubstr("open loop: link"));
    EXPECT_LT(proof.until, 0.43);
  }
}

TEST(Proof, WhatIsNotProvenIsNotCertifiedWhereAProofIsDemanded) {
  Trajectory trajectory = reference_trajectory();
  trajectory.samples.resize(100);
  Certificate certificate;
  certificate.certified = true;
  demand_proof(robot(), robot_limits(), trajectory, certificate);
  EXPECT_TRUE(certificate.certified && certificate.proof.proven);
  trajectory.samples[50].state.q[0] += 1.5e-4;
  demand_proof(robot(), robot_limits(), trajectory, certificate);
  EXPECT_FALSE(certificate.certified);
  EXPECT_THAT(certificate.failures, testing::ElementsAre(HasSubstr("not proven from t = 0.049")));
}

TEST(Proof, FeedbackBeyondWhatIsAllowedIsNotProven) {
  Trajectory trajectory = reference_trajectory();
  for (Sample& row : trajectory.samples) row.torque[1] += 0.01;
  Claims claims = Claims::of(robot(), robot_limits());
  claims.feedback[1] = 0.002;
  EXPECT_THAT(prove(robot(), trajectory, claims).closed_loop.reason, HasSubstr("feedback torque of joint 2"));
}

TEST(Proof, WhatIsNoTrajectoryIsNotProven) {
  Trajectory trajectory = reference_trajectory();
  trajectory.samples[7].torque[0] = HUGE_VAL;
  EXPECT_FALSE(proof_of(trajectory).proven);
  trajectory = reference_trajectory();
  for (Sample& row : trajectory.samples) row.torque[0] = 1e300;
  EXPECT_FALSE(proof_of(trajectory).proven);
}

// Motions of all kinds, through reversals of both motors: where SUNDIALS comes to is in the enclosure, up to its error.
TEST(Proof, RolloutsLieInTheEnclosure) {
  constexpr double kPosition = 1e-9, kVelocity = 5e-8;  // [rad], [rad/s] its errors, and those of its interpolation
  const Accuracy tight{1e-12, 1e-14, 1e-13, 1e-13};
  for (int motion = 0; motion < 6; ++motion) {
    const double a = 2 + motion, b = 0.5 + 0.3 * motion, w = 9 + 4 * motion;
    const auto torque = [&](double t) { return Joints<double>{a * std::sin(w * t), b * std::cos(1.3 * w * t)}; };
    Trajectory trajectory;  // its states are no motion: in open loop they do not matter
    for (int k = 0; k <= 150; ++k) {
      trajectory.samples.push_back({k * 2e-3, rest_at(robot(), {0.3, -0.4}), torque(k * 2e-3)});
    }
    std::vector<double> times;
    std::vector<std::array<Ball, kStates>> sets;
    const std::vector<Piece> open{{trajectory.end_time(), Drive::open_loop(trajectory), true}};
    const auto keep = [&](const ArmStep& step) {
      if (step.time <= (times.empty() ? 0 : times.back() + 1e-6)) return true;
      times.push_back(step.time);
      sets.emplace_back();
      for (std::size_t i = 0; i < kStates; ++i) sets.back()[i] = step.solution.near[i][0];
      return true;
    };
    ASSERT_TRUE(follow(robot(), trajectory, open, keep).completed);
    Rollout rollout(robot(), Limits{}, tight);
    rollout.start(0, trajectory.samples.front().state, Drive::open_loop(trajectory));
    std::size_t k = 0;
    ASSERT_TRUE(
        rollout.run(trajectory.end_time(), times, torque_corners(trajectory, 0), [&](double, const State<double>& x) {
          for (std::size_t i = 0; i < kStates; ++i) {
            const double error = i / kJoints % 2 == 0 ? kPosition : kVelocity;
            EXPECT_NEAR(x[i], sets[k][i].mid, sets[k][i].rad + error) << motion << ' ' << i;
            EXPECT_LT(sets[k][i].rad, 1e-7);
          }
          ++k;
        }));
    EXPECT_EQ(k, times.size());
  }
}

TEST(Reach, FindsTheLargestMagnitude) {
  Reach reach(10);
  EXPECT_TRUE(reach.include({1.0, 4.0, -4.0}, 1.0, 5));  // 2 at 0.5
  EXPECT_NEAR(reach.bound(), 2, 1e-5);
  EXPECT_GE(reach.bound(), 2);
  EXPECT_NEAR(reach.time(), 5.5, 0.01);
  EXPECT_TRUE(reach.include({-3.0, 0.0, 1.0}, 1.0, 6));
  EXPECT_GE(reach.bound(), 3);
  EXPECT_FALSE(reach.include({0.0, 20.0 + 1e-9}, 0.5, 7));
  EXPECT_FALSE(Reach(1).include({Ball(0, 1.0 + 1e-12), 0.0}, 0.5, 7));
  EXPECT_FALSE(Reach(1).include({Ball::unbounded(), 0.0}, 0.5, 7));
}

}  // namespace
}  // namespace fjr
