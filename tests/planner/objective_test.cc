// The terms of the objective: their values in plan.json against independent quadratures, and that minimising one gives
// less of it than minimising another.
#include "planner/ocp/objective.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "common/dual.h"
#include "model/flatness.h"
#include "planner/plan.h"
#include "planner/problem/objective_terms.h"
#include "planner/problem/quantities.h"
#include "planner/request/request.h"

namespace fjr {
namespace {

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

const char* const kMove = "start: {q: [0.0, 0.0]}\ngoal: {q: [0.4, -0.2]}\n";

Plan planned(const std::string& more, int starts = 0) {
  PlanOptions options;
  options.starts = starts;
  Plan result = plan(request(kMove + more), options);
  EXPECT_EQ(result.status, PlanStatus::kCertified) << more << ": " << result.reason;
  return result;
}

// The midpoint rule on a grid that knows nothing of the rows, many times finer than they are.
double integral(const Trajectory& rows, const std::function<double(const Sample&)>& f) {
  constexpr int kPieces = 100'000;
  Interpolator at(rows);
  const double h = rows.end_time() / kPieces;
  double sum = 0;
  for (int i = 0; i < kPieces; ++i) sum += f(at.at((i + 0.5) * h)) * h;
  return sum;
}

// The parts of an instant, for patterns of what a formula depends on.
enum Part { kState, kAcceleration, kMotorTorque, kRate, kParts };
using Parts = Pattern<kParts>;

Joints<Parts> both(Part part) { return {Parts::input(1, part), Parts::input(1, part)}; }

// What the list says of a formula decides which derivatives are computed and how friction is sharpened: a term that
// forgot to say that it sees the acceleration would be optimised with an acceleration of zero.
TEST(Terms, SayWhatTheirFormulasDependOn) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  const State<Parts> x{both(kState), both(kState), both(kState), both(kState)};
  const Joints<Parts> ddq = both(kAcceleration), torque = both(kMotorTorque);
  int integrals = 0;
  Terms::visit([&](auto term) {
    if constexpr (requires { term.running(Instant<Parts>{robot, x, ddq, torque}); }) {
      ++integrals;
      const Parts cost = term.running(Instant<Parts>{robot, x, ddq, torque});
      EXPECT_EQ(cost.depends_on(kAcceleration), term.info.sees_acceleration) << term.info.name;
      EXPECT_EQ(cost.depends_on(kMotorTorque), term.info.sees_friction) << term.info.name;
    }
  });
  EXPECT_GE(integrals, 5);
}

TEST(Quantities, SayWhatTheirFormulasDependOn) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  const State<Parts> x{both(kState), both(kState), both(kState), both(kState)};
  const Joints<Parts> torque = both(kMotorTorque), rate = both(kRate);
  Quantities::visit([&](auto quantity) {
    for (const Parts& value : quantity.value(Moment<Parts>{robot, x, torque, rate})) {
      EXPECT_EQ(value.depends_on(kMotorTorque), quantity.info.sees_torque) << quantity.info.name;
      EXPECT_EQ(value.depends_on(kRate), quantity.info.bound == BoundOn::kControl) << quantity.info.name;
    }
  });
}

double squared(const Joints<double>& v) { return v[0] * v[0] + v[1] * v[1]; }

// Link velocities of the rows, differentiated twice by central differences over 1 ms.
double jerk_by_differences(const Trajectory& rows) {
  Interpolator at(rows);
  constexpr double kStep = 1e-3;
  double sum = 0;
  for (double t = kStep; t < rows.end_time() - kStep; t += kStep) {
    const Sample before = at.at(t - kStep), here = at.at(t), after = at.at(t + kStep);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double jerk = (before.state.dq[j] - 2 * here.state.dq[j] + after.state.dq[j]) / (kStep * kStep);
      sum += jerk * jerk * kStep;
    }
  }
  return sum;
}

// Friction lets the rows end with less torque than gravity asks for; the arm that is then held has none of its help.
TEST(Objective, PeakTorqueCountsWhatHoldingTheGoalTakes) {
  const Problem problem = request(
      "{start: {q: [0.2, 0.0]}, goal: {q: [1.0, 0.1]}, duration: 1.5, "
      "objective: {peak_torque: 1, effort: 0.01}}");
  PlanOptions options;
  options.starts = 1;
  const Plan result = plan(problem, options);
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  const Joints<double> held = gravity_torque(problem.robot, problem.goal.q);
  double needed = 0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    double peak = std::abs(held[j]);
    for (const Sample& row : result.trajectory->samples) peak = std::max(peak, std::abs(row.torque[j]));
    needed += peak;
  }
  EXPECT_NEAR(result.terms.at("peak_torque"), needed, 1e-9);
}

// Where a motor reverses, its torque steps by twice its friction, most often between two collocation points.
TEST(Objective, PeakTorqueIsKeptBetweenTheCollocationPoints) {
  PlanOptions options;
  options.starts = 1;
  for (const char* motion :
       {"{start: {q: [0.1, 0.5]}, goal: {q: [0.8, -0.9]}, duration: 0.9, objective: {peak_torque: 1}}",
        "{start: {q: [-0.9, 0.4]}, goal: {q: [-0.3, -0.4]}, objective: {time: 40, peak_torque: 1}}"}) {
    const Plan result = plan(request(motion), options);
    ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
    // The last is the bound that the optimiser pushed down. Without margins the rows have 1.155 and 1.044 times as
    // much.
    EXPECT_LT(result.objective, 1.02 * result.stages.back().objective) << motion;
  }
}

double largest_torque_of(const std::string& yaml) {
  PlanOptions options;
  options.starts = 1;
  const Plan result = plan(request(yaml), options);
  EXPECT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  return result.terms.at("peak_torque");
}

// Whatever moves the arm in this time bounds the least peak from above: here the fastest motion within tighter limits,
// and motions that save effort besides. The tolerance is for meshes and rows, which may each cost a few 1e-4.
TEST(Objective, PeakTorqueIsNoHigherThanThatOfOtherMotionsInTheSameTime) {
  constexpr double kTolerance = 2e-3;
  const std::string fast = "start: {q: [-0.99, 0.36]}, goal: {q: [-0.32, -0.38]}";
  const Plan fastest = plan(request(fmt::format("{{{}, limits: {{torque: [8.27, 3.22]}}}}", fast)), {});
  ASSERT_EQ(fastest.status, PlanStatus::kCertified) << fastest.reason;
  EXPECT_LT(largest_torque_of(fmt::format("{{{}, duration: {}, objective: {{peak_torque: 1}}}}", fast,
                                          fastest.trajectory->samples.back().time)),
            (1 + kTolerance) * fastest.terms.at("peak_torque"));

  const std::string ends = "start: {q: [0.5045, 0.8019]}, goal: {q: [0.3418, -1.2536]}, duration: 0.752";
  const double least = largest_torque_of(fmt::format("{{{}, objective: {{peak_torque: 1}}}}", ends));
  for (const double effort : {0.01, 0.1}) {
    EXPECT_LT(least, (1 + kTolerance) * largest_torque_of(fmt::format(
                                            "{{{}, objective: {{peak_torque: 1, effort: {}}}}}", ends, effort)))
        << "effort " << effort;
  }
}

// The start is no stage of radau3, so that nothing but the first interval's bounds keeps its variables.
TEST(Objective, PeakTorqueIsPlannedBySchemesWithoutAPointAtTheStart) {
  std::vector<double> objectives;
  for (const char* method : {"lobatto4", "radau3"}) {
    const Problem problem =
        request(fmt::format("{{start: {{q: [0.2, 0.0]}}, goal: {{q: [1.0, 0.1]}}, duration: 0.9, "
                            "objective: {{peak_torque: 1, effort: 0.01}}, method: {}}}",
                            method));
    PlanOptions options;
    options.starts = 1;
    const Plan result = plan(problem, options);
    ASSERT_EQ(result.status, PlanStatus::kCertified) << method << ": " << result.reason;
    objectives.push_back(result.objective);
  }
  EXPECT_NEAR(objectives[1], objectives[0], 0.2 * objectives[0]);  // 8.0 to 8.7 with all four schemes
}

TEST(Objective, WhatHoldingTakesCountsForRowsThatEndAtRestAlone) {
  const Problem problem = request("{start: {q: [0.0, 0.0]}, goal: {q: [1.0, 0.2]}, objective: {time: 1}}");
  const Joints<double> held = gravity_torque(problem.robot, problem.goal.q);
  Trajectory rows;
  rows.samples = {{0, problem.start, {0.5, 0.1}}, {1, rest_at(problem.robot, problem.goal.q), {0.2, 0.1}}};
  const auto peak = [&](double speed) {
    rows.samples.back().state.dq[0] = speed;
    return PeakTorque::published({{}, rows, problem.robot, 0});
  };
  EXPECT_DOUBLE_EQ(peak(1e-17), std::abs(held[0]) + std::max(0.1, std::abs(held[1])));  // what roundings leave of rest
  EXPECT_DOUBLE_EQ(peak(0.1), 0.5 + 0.1);
}

TEST(Objective, TermsAreTheIntegralsOfThePublishedRows) {
  const Problem problem = request(std::string(kMove) + "duration: 0.8\nobjective: {effort: 1, link_jerk: 1e-6}\n");
  const Plan result = plan(problem, {});
  ASSERT_TRUE(result.trajectory) << result.reason;
  const Trajectory& rows = *result.trajectory;
  const Parameters& robot = problem.robot;
  const auto expect = [&](const char* name, double value, double relative) {
    EXPECT_NEAR(result.terms.at(name), value, relative * value) << name;
  };
  // The rows' quadrature and this one differ where a tanh of the friction, or a corner at zero power, lies between
  // rows.
  expect("effort", integral(rows, [](const Sample& s) { return squared(s.torque); }), 1e-4);
  expect(
      "copper",
      integral(rows, [](const Sample& s) { return 0.5 * s.torque[0] * s.torque[0] + 1.5 * s.torque[1] * s.torque[1]; }),
      1e-4);
  expect("energy",
         integral(rows,
                  [](const Sample& s) {
                    return std::max(0.0, s.torque[0] * s.state.dtheta[0]) +
                           std::max(0.0, s.torque[1] * s.state.dtheta[1]);
                  }),
         1e-4);
  expect("link_acceleration",
         integral(rows,
                  [&](const Sample& s) {
                    return squared(link_motion(robot, s.state, {0, 0}).ddq);  // whatever the torque
                  }),
         1e-4);
  expect("link_jerk",
         integral(rows,
                  [&](const Sample& s) {
                    return squared(link_motion(robot, s.state, {0, 0}).dddq);
                  }),
         1e-4);
  expect("link_jerk", jerk_by_differences(rows), 0.02);  // differences over 1 ms of oscillations at up to 50 rad/s
  double peak1 = 0, peak2 = 0;
  for (const Sample& s : rows.samples) {
    peak1 = std::max(peak1, std::abs(s.torque[0]));
    peak2 = std::max(peak2, std::abs(s.torque[1]));
  }
  EXPECT_EQ(result.terms.at("peak_torque"), peak1 + peak2);
  EXPECT_NEAR(result.terms.at("tip_speed"), 0, 1e-7);  // of the goal, where the arm rests
  EXPECT_NEAR(result.objective, result.terms.at("effort") + 1e-6 * result.terms.at("link_jerk"), 1e-9);
}

// Each of these has less of its own term than every other. Several minima: none need be the least there is.
TEST(Objective, MinimisingATermGivesLessOfItThanMinimisingOthers) {
  const std::vector<std::string> terms{"effort", "link_acceleration", "link_jerk", "energy", "peak_torque"};
  std::vector<Plan> plans;
  for (const std::string& term : terms) plans.push_back(planned("duration: 0.8\nobjective: {" + term + ": 1}\n", 2));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    ASSERT_TRUE(plans[i].trajectory);
    for (std::size_t k = 0; k < terms.size(); ++k) {
      // Acceleration and jerk may be nearly the same motion; the regularisation by effort costs up to a per cent.
      EXPECT_LE(plans[i].terms.at(terms[i]), 1.01 * plans[k].terms.at(terms[i])) << terms[i] << " of " << terms[k];
    }
  }
}

// Without limits the least int dddq^2 from rest to rest is 720 d^2 / T^5, of q = 10 s^3 - 15 s^4 + 6 s^5 (Flash &
// Hogan, Journal of Neuroscience 5(7), 1985). Its jerk begins with a jump, which takes the motors some time: a little
// more.
TEST(Objective, LeastJerkIsNearlyThatOfTheQuintic) {
  const Plan slow = planned("duration: 1.5\nobjective: {link_jerk: 1}\n", 1);
  const double quintic = 720 * (0.4 * 0.4 + 0.2 * 0.2) / std::pow(1.5, 5);
  EXPECT_GT(slow.terms.at("link_jerk"), quintic);
  EXPECT_LT(slow.terms.at("link_jerk"), 1.02 * quintic);
}

// Whoever has longer may do the same, later or slower. A regularisation by effort that outweighed the term would not
// let it: with one, the longer motion took 1.8 times as much.
TEST(Objective, TorqueRateNeedsNoMoreInALongerTime) {
  const std::string least = "objective: {torque_rate: 1}\n";
  const Plan shorter = planned("duration: 0.8\n" + least), longer = planned("duration: 1.6\n" + least);
  // The optimum of both takes as much where waiting is best; the optimiser ends within its tolerance of it.
  EXPECT_LE(longer.terms.at("torque_rate"), 1.001 * shorter.terms.at("torque_rate"));
}

// Copper losses are effort with a weight per joint: equal coefficients make them the same problem, though with another
// scale the optimiser may end in another of its minima, which lie some per cent apart.
TEST(Objective, CopperWithEqualCoefficientsIsEffort) {
  Problem copper = request(std::string(kMove) + "duration: 0.8\nobjective: {copper: 0.5}\n");
  copper.robot.drive.copper_loss = {2, 2};
  const Problem effort = request(std::string(kMove) + "duration: 0.8\nobjective: {effort: 1}\n");
  PlanOptions options;
  options.starts = 1;
  const Plan one = plan(copper, options), other = plan(effort, options);
  ASSERT_TRUE(one.trajectory && other.trajectory);
  EXPECT_NEAR(one.objective, other.objective, 0.05 * other.objective);
  EXPECT_NEAR(one.terms.at("copper"), 2 * one.terms.at("effort"), 1e-9 * one.terms.at("copper"));
}

// A throw: through a place, as fast there as it may be, and to rest behind it.
TEST(Objective, ATipSpeedIsGainedAtTheRelease) {
  const std::string through = "via: [{q: [0.3, 0.2]}]\nduration: {max: 0.6}\nobjective: ";
  const Plan fastest = planned(through + "fastest\n"), thrown = planned(through + "{time: 1, tip_speed: 1}\n", 1);
  ASSERT_TRUE(fastest.trajectory && thrown.trajectory);
  EXPECT_GT(thrown.terms.at("tip_speed"), 1.2 * fastest.terms.at("tip_speed"));
  // In the rows: there is an instant at that place, and this is the tip's speed there.
  const Parameters robot = request(kMove).robot;
  double least = 1, speed = 0;
  for (const Sample& s : thrown.trajectory->samples) {
    const double away = std::hypot(s.state.q[0] - 0.3, s.state.q[1] - 0.2);
    if (away < least) {
      least = away;
      speed = std::sqrt(tip_speed_squared(robot, s.state.q[1], s.state.dq));
    }
  }
  EXPECT_LT(least, 0.01);
  EXPECT_NEAR(thrown.terms.at("tip_speed"), speed, 0.02 * speed);  // rows are 1 ms apart
  EXPECT_NEAR(thrown.objective, thrown.duration - thrown.terms.at("tip_speed"), 1e-9);
}

TEST(Objective, AGoalOfFreeVelocityIsPassedAsFastAsItMayBe) {
  const Problem problem = request(
      "{start: {q: [0.0, 0.0]}, goal: {q: [0.6, 0.3], dq: free}, duration: {max: 0.8}, "
      "objective: {time: 1, tip_speed: 1}, limits: {tip_speed: 2.5}}");
  PlanOptions options;
  options.starts = 1;
  const Plan result = plan(problem, options);
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  // The limit is within the arm's reach, so it is what limits; the usual base margin is 1e-4 of it.
  EXPECT_NEAR(result.terms.at("tip_speed"), 2.5, 2e-3);
}

}  // namespace
}  // namespace fjr
