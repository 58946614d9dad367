// Proofs against what must be true: what is exact by construction is proven, what misses a bound by 1e-9 never is, and
// integrations that share no code with the enclosure lie inside of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "planner/certificate/proof/arm_flow.h"
#include "planner/certificate/proof/prove.h"
#include "planner/certificate/proof/reach.h"
#include "planner/certificate/proof/task_reaches.h"
#include "planner/certificate/rollout.h"
#include "planner/certificate/thresholds.h"
#include "planner/plan.h"
#include "planner/problem/task/task.h"
#include "planner/request/request.h"
#include "support/exact_trajectories.h"

namespace fjr {
namespace {

using enclosure::Ball;
using testing::HasSubstr;
using testing::IsEmpty;

Proof proof_of(const Trajectory& trajectory) { return prove(robot(), robot_limits(), {}, trajectory); }

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
  demand_proof(robot(), robot_limits(), {}, trajectory, certificate);
  EXPECT_TRUE(certificate.certified && certificate.proof.proven);
  trajectory.samples[50].state.q[0] += 1.5e-4;
  demand_proof(robot(), robot_limits(), {}, trajectory, certificate);
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

TEST(Proof, IsStoppedOnRequest) {
  const auto stopped = [] { return true; };
  const Proof proof = prove(robot(), robot_limits(), {}, reference_trajectory(), one_after_another, stopped);
  EXPECT_FALSE(proof.proven || proof.open_loop.proven || proof.closed_loop.proven);
  EXPECT_THAT(proof.reason, HasSubstr("stopped on request"));
  EXPECT_LT(proof.closed_loop.steps, 200);
}

TEST(Proof, AsksWhetherThePlanIsCancelled) {
  const Problem problem = parse_request("start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\n", "r.yaml", robot());
  PlanOptions options;
  options.jobs = 1;  // as often asked in either run
  int asked = 0, most = std::numeric_limits<int>::max();
  options.cancelled = [&] { return ++asked > most; };
  EXPECT_EQ(plan(problem, options).status, PlanStatus::kCertified);
  most = asked;
  asked = 0;
  options.proven = true;
  const Plan cancelled = plan(problem, options);
  EXPECT_EQ(cancelled.status, PlanStatus::kCancelled);
  EXPECT_EQ(cancelled.reason, "stopped on request");
  EXPECT_FALSE(cancelled.trajectory || cancelled.certificate);
}

// On all threads, and nothing of it stays.
TEST(Proof, WhichWayItsCallerRoundsIsNothingToIt) {
  Trajectory trajectory = reference_trajectory();
  trajectory.samples.resize(30);
  const Proof usual = proof_of(trajectory);
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
  const auto on_threads = [](std::size_t count, const auto& task) { for_each_index(count, 2, task); };
  const Proof upward = prove(robot(), robot_limits(), {}, trajectory, on_threads);
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  std::fesetround(FE_TONEAREST);
  EXPECT_TRUE(upward.proven);
  EXPECT_EQ(upward.open_loop.link, usual.open_loop.link);
  EXPECT_EQ(upward.closed_loop.feedback_torque, usual.closed_loop.feedback_torque);
  for (std::size_t i = 0; i < usual.limits.size(); ++i) {
    EXPECT_EQ(upward.limits[i].published, usual.limits[i].published) << usual.limits[i].name;
    EXPECT_EQ(upward.limits[i].rollout, usual.limits[i].rollout) << usual.limits[i].name;
  }
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

// ---- the task ----

// A row of one bound, for a motion that leaves it `least` at an extreme value or distance.
struct RowCase {
  const char* name;
  TaskRow row;  // without its bound
  bool is_lower;

  // With a bound that leaves so much of it free.
  TaskRow leaving(double clearance, double extreme) const {
    TaskRow r = row;
    const double bound = is_lower ? extreme - clearance : extreme + clearance;
    const bool of_distance = !r.is_distance();
    if (of_distance) r.number = bound;
    r.lower = is_lower ? (of_distance ? 0 : bound) : -task::kNone;
    r.upper = is_lower ? task::kNone : (of_distance ? 0 : bound);
    return r;
  }
};

// What a row is about: its value, or the distance that it is the square of.
double measured(const TaskRow& row, const Joints<double>& q) {
  const auto at = Posture<double>::of(robot(), q);
  if (row.is_distance()) return row.value(robot(), at);
  TaskRow unit = row;
  unit.number = 1;
  return std::sqrt(1 + 2 * unit.value(robot(), at));
}

// The largest, or the least, at instants that are close enough to tell 1e-10 of it: 60 times between two rows.
double extreme_of(const RowCase& c, const Trajectory& trajectory, double from, double to) {
  constexpr int kParts = 60;
  Interpolator plan(trajectory);
  double extreme = c.is_lower ? HUGE_VAL : -HUGE_VAL;
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    for (int i = 0; i <= kParts; ++i) {
      const double begin = trajectory.samples[k].time, end = trajectory.samples[k + 1].time;
      const double time = begin + (end - begin) * i / kParts;
      if (time < from || time > to) continue;
      const double value = measured(c.row, plan.at(time).state.q);
      extreme = c.is_lower ? std::min(extreme, value) : std::max(extreme, value);
    }
  }
  return extreme;
}

// All kinds of rows; discs beside both links, at the elbow and beyond the tip, where the nearest point of the link is
// in between, an end, or goes from one to the other.
std::vector<RowCase> row_cases() {
  using Kind = TaskRow::Kind;
  const State<double> middle = Interpolator(reference_trajectory()).at(0.1).state;
  const auto at = Posture<double>::of(robot(), middle.q);
  const auto row = [](Kind kind, const task::Two& vector) {
    return TaskRow{kind, vector, kind == Kind::kTipRadius ? 0.3 : 0, 0, 0, 0.1, "row", 0, nullptr, 0};
  };
  const auto from = [](const Point<double>& p, double x, double y) { return task::Two{p.x + x, p.y + y}; };
  const Point<double> half{(at.elbow.x + at.tip.x) / 2, (at.elbow.y + at.tip.y) / 2};
  const double beyond = 0.08 / robot().link.length[1];
  const auto last = Posture<double>::of(robot(), reference_trajectory().samples.back().state.q);
  const double angle = last.q[0] + last.q[1];  // 5 cm ahead of the end of the link, where that comes to rest
  const task::Two ahead = from(last.tip, 0.05 * std::cos(angle) - 0.005 * std::sin(angle),
                               0.05 * std::sin(angle) + 0.005 * std::cos(angle));
  return {
      {"tip, from below", row(Kind::kTip, {0.6, 0.8}), true},
      {"tip, from above", row(Kind::kTip, {0.6, -0.8}), false},
      {"elbow", row(Kind::kElbow, {-0.8, 0.6}), true},
      {"angles", row(Kind::kAngles, {0.5, 1}), false},
      {"inside of a circle", row(Kind::kTipRadius, {0.1, -0.3}), false},
      {"outside of a circle", row(Kind::kTipRadius, from(at.tip, 0.1, 0.05)), true},
      {"disc beside link 1", row(Kind::kClearance1, {0.2, -0.1}), true},
      {"disc at the elbow", row(Kind::kClearance1, from(at.elbow, 0.05, -0.07)), true},
      {"disc beside link 2", row(Kind::kClearance2, from(half, 0.1, 0.02)), true},
      {"disc beyond the tip",
       row(Kind::kClearance2, from(at.tip, beyond * (at.tip.x - at.elbow.x), beyond * (at.tip.y - at.elbow.y))), true},
      {"disc ahead of the tip", row(Kind::kClearance2, ahead), true}};
}

TaskOfMotion task_with(const std::vector<TaskRow>& rows) { return {{rows}, {reference_trajectory().end_time()}}; }

// The published rows against one row of a task that may not be missed at all; what is proven to be left free of it.
struct OfRows {
  bool kept = true;
  double clearance = 0;
};
OfRows proven_by_rows(const TaskRow& row, const Trajectory& trajectory) {
  const TaskOfMotion task = task_with({row});
  TaskReaches reaches(robot(), task, 6, [](const TaskRow&) { return 0.0; });
  OfRows result;
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    const RowPolynomials near = RowPolynomials::between(trajectory.samples[k], trajectory.samples[k + 1]);
    const RowPolynomials over = near.shifted(Ball::between(0, near.duration.upper()));
    result.kept =
        result.kept && reaches.include({near.state.q, over.state.q}, near.duration, trajectory.samples[k].time, 0);
  }
  result.clearance = reaches.clearances().front().clearance;
  return result;
}

TEST(ProofOfTasks, WhatIsMissedByANanometreIsNeverProven) {
  const Trajectory& trajectory = reference_trajectory();
  for (const RowCase& c : row_cases()) {
    SCOPED_TRACE(c.name);
    const double extreme = extreme_of(c, trajectory, 0, trajectory.end_time());
    EXPECT_FALSE(proven_by_rows(c.leaving(-1e-9, extreme), trajectory).kept);
    // Extremes are found to 1e-6 of the row's scale, 0.1 m or rad; squares of distances to that of the distance.
    constexpr double kFound = 4e-7;
    const OfRows proven = proven_by_rows(c.leaving(kFound, extreme), trajectory);
    EXPECT_TRUE(proven.kept);
    EXPECT_LE(proven.clearance, kFound + 1e-14);
    EXPECT_GE(proven.clearance, 0);
  }
}

TEST(ProofOfTasks, TheExactMotionKeepsThemTooAndBoundsAreNotAboveIt) {
  Trajectory trajectory = bulging(0.5 * exactness_tolerance(robot()));
  trajectory.samples.resize(250);
  const std::vector<State<double>> exact = integrated(trajectory);  // in closed loop it is 1e-10 rad from there or less
  std::vector<TaskRow> rows;
  std::vector<double> of_rows, of_motion;
  for (const RowCase& c : row_cases()) {
    constexpr double kClearance = 0.01;
    const TaskRow row = c.leaving(kClearance, extreme_of(c, trajectory, 0, trajectory.end_time()));
    rows.push_back(row);
    rows.back().name = c.name;
    double least = HUGE_VAL;
    for (const State<double>& x : exact) {
      least = std::min(least, row.distance(row.value(robot(), Posture<double>::of(robot(), x.q))));
    }
    of_motion.push_back(least);
    of_rows.push_back(kClearance);
  }
  const TaskOfMotion task = task_with(rows);
  const Proof proof = prove(robot(), robot_limits(), task, trajectory);
  ASSERT_TRUE(proof.proven) << proof.reason;
  ASSERT_EQ(proof.task.size(), rows.size());
  constexpr double kFeedback = 5e-5;  // [m] of a motion that is half a count off the plan, less in closed loop
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_LE(proof.task[i].published, of_rows[i] + 1e-12) << rows[i].name;
    EXPECT_GE(proof.task[i].published, of_rows[i] - 4e-7) << rows[i].name;
    EXPECT_NEAR(proof.task[i].rollout, of_motion[i], kFeedback) << rows[i].name;
  }
}

TEST(ProofOfTasks, RowsHoldInTheirSegmentAlone) {
  const Trajectory& trajectory = reference_trajectory();
  constexpr double kEnd = 0.1003;  // [s] between rows
  const RowCase angle{"angle", {TaskRow::Kind::kAngles, {1, 0}, 0, 0, 0, 0.1, "path", 0, nullptr, 0}, false};
  const double before = extreme_of(angle, trajectory, 0, kEnd), after = extreme_of(angle, trajectory, kEnd, 0.43);
  ASSERT_GT(after, before + 1e-3);
  const auto proof_with = [&](double first, double second) {
    const TaskOfMotion task{{{angle.leaving(0, first)}, {angle.leaving(0, second)}}, {kEnd, trajectory.end_time()}};
    return prove(robot(), robot_limits(), task, trajectory);
  };
  constexpr double kRoom = 1e-6;  // [rad] that instants 1/60 ms apart may have passed over
  EXPECT_TRUE(proof_with(before + kRoom, after + kRoom).proven);
  const Proof refused = proof_with(before + kRoom, before);
  EXPECT_FALSE(refused.proven);
  EXPECT_THAT(refused.reason, HasSubstr("not proven from t = 0.100"));
  EXPECT_THAT(refused.reason, HasSubstr("path may be missed by"));
  // What rounding may take is a millionth of the scale, 1e-7 rad; a nanoradian more is refused.
  EXPECT_FALSE(proof_with(before + kRoom, after - 1e-7 - 1e-9).proven);
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

TEST(Reach, FindsTheLargestValue) {
  Reach reach = Reach::of_values(-1, 10);
  EXPECT_TRUE(reach.include({-6.0, 4.0, -4.0}, 1.0, 5));  // -5 at 0.5
  EXPECT_NEAR(reach.bound(), -5, 1e-5);
  EXPECT_GE(reach.bound(), -5);
  EXPECT_FALSE(reach.include({-2.0, 0.0, 4.0 * (1 + 1e-9)}, 0.5, 6));
  EXPECT_GT(reach.bound(), -1);
}

}  // namespace
}  // namespace fjr
