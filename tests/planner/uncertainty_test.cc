// Margins for the arms that an identification leaves possible, against rollouts of such arms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/input_error.h"
#include "common/normal.h"
#include "common/parallel.h"
#include "planner/certificate/robust/robustness.h"
#include "planner/certificate/robust/sensitivities.h"
#include "planner/certificate/simulation.h"
#include "planner/certificate/ticks.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/trajectory/trajectory.h"
#include "support/exact_trajectories.h"
#include "support/uncertain_arm.h"

namespace fjr {
namespace {

using testing::HasSubstr;

std::vector<State<double>> rolled_out(const Parameters& planned_for, const Parameters& arm) {
  std::vector<State<double>> states;
  roll_out_ticks(planned_for, arm, reference_trajectory(), start_on(planned_for, arm, reference_trajectory()),
                 [&](const SimulatedTick& tick) { states.push_back(tick.state); });
  return states;
}

// The executor's rollouts of neighbouring arms are exact to 1e-7 rad, and differ by 1e-4 rad and more: a difference
// quotient over 0.2 of 1 % is good to 1e-3 of its largest value, and to some more where little depends on a parameter,
// as on link 2's gravity (measured: 6e-3). Ticks of 1 ms over swings of 50 rad/s make 1e-4.
// At 0.195 s motor 1 reverses within a tick. What the step of friction makes of that depends on how fast the motor is
// there, which cubics between rows of 1 ms tell to some per cent (measured: 4).
TEST(Sensitivities, AreThoseOfRolloutsOfNeighbouringArms) {
  const Parameters p = uncertain(with_fine_encoders(robot()), 0.01);
  const Uncertainty& u = *p.uncertainty;
  const Sensitivities s = sensitivities(p, reference_trajectory(), u);
  ASSERT_EQ(s.times.size(), 430U);
  for (std::size_t i = 0; i < u.names.size(); ++i) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(u.names.size()));
    const auto column = static_cast<Eigen::Index>(i);
    step[column] = 0.2 * u.standard_error(i);
    const auto more = rolled_out(p, changed(p, u.names, step)), less = rolled_out(p, changed(p, u.names, -step));
    for (Eigen::Index row = 0; row < kStates; ++row) {
      double largest = 0, worst = 0, worst_before = 0;
      for (std::size_t k = 0; k < s.times.size(); ++k) {
        const auto state = static_cast<std::size_t>(row);
        const double quotient = (more[k][state] - less[k][state]) / (2 * step[column]);
        largest = std::max(largest, std::abs(quotient));
        const double error = std::abs(quotient - s.state[k](row, column));
        worst = std::max(worst, error);
        if (s.times[k] < 0.195) worst_before = worst;
      }
      EXPECT_LT(worst_before, 1e-2 * largest) << u.names[i] << ", state " << row;
      EXPECT_LT(worst, 0.06 * largest) << u.names[i] << ", state " << row;
    }
  }
}

TEST(Sensitivities, EquivalentGainsAreThoseOfTheLaw) {
  using Encoder = EquivalentGain::Encoder;
  const EquivalentGain motor(robot(), 0, Encoder::kMotor), link(robot(), 0, Encoder::kLink);
  const double of_motor = count_angle(4000), of_link = count_angle(65536);
  // Errors far below a count are seen where they move the reading by one, with probability error / count, and then as
  // half a count and half the error: E (1/2 + |x| / 2 count) x^2 / E x^2, with E |x|^3 = 1.596 for a standard deviation
  // of 1. Far above, all of them.
  EXPECT_NEAR(motor.at(of_motor / 16), 0.5 + 1.596 / 2 / 16, 1e-3);
  EXPECT_NEAR(motor.at(20 * of_motor), 1, 0.01);
  EXPECT_LT(motor.at(of_motor / 2), motor.at(2 * of_motor));
  // The links' law is for errors up to half a count of the motor, 8 of the link.
  EXPECT_GT(link.at(3 * of_link), 0.7);
  EXPECT_LT(link.at(300 * of_link), 0.05);
}

double binomial_at_most(std::size_t k, std::size_t n, double p) {
  double sum = 0;
  for (std::size_t i = 0; i <= k; ++i) {
    const auto count = static_cast<double>(n), of = static_cast<double>(i);
    sum += std::exp(std::lgamma(count + 1) - std::lgamma(of + 1) - std::lgamma(count - of + 1) + of * std::log(p) +
                    (count - of) * std::log1p(-p));
  }
  return sum;
}

TEST(Robustness, DrawsAreAsManyAsTheCertaintyTakes) {
  for (const double confidence : {0.9, 0.99, 0.999}) {
    const Draws draws = draws_for(confidence);
    EXPECT_LE(binomial_at_most(draws.outside, draws.arms, 1 - confidence), 1 - kCertainty);
    EXPECT_GT(binomial_at_most(draws.outside, draws.arms - 1, 1 - confidence), 1 - kCertainty);
  }
  EXPECT_EQ(draws_for(0.99).arms, 628U);
}

// visit(arm) for so many of the arms that the robot's uncertainty leaves possible, the same ones for the same seed.
template <class Visit>
void each_drawn_arm(const Parameters& p, int count, std::uint64_t seed, const Visit& visit) {
  const Uncertainty u = uncertainty_of(p);
  const Eigen::MatrixXd factor = u.factor();
  Normal normal(seed);
  for (int n = 0; n < count; ++n) {
    Eigen::VectorXd drawn(factor.cols());
    for (double& number : drawn) number = normal();
    visit(changed(p, u.names, factor * drawn));
  }
}

// Other arms than those by which the tubes were found, with errors near a count and far above.
class RobustTrial : public testing::TestWithParam<double> {};

TEST_P(RobustTrial, ArmsStayWithinWhatIsPromisedAndNotFarWithin) {
  const Parameters p = uncertain(robot(), GetParam());
  const Limits limits = robot_limits();
  constexpr double kConfidence = 0.9;
  const Robustness r = robustness(p, limits, {}, reference_trajectory(), kConfidence);
  constexpr int kArms = 300;
  int within = 0, within_half = 0;
  each_drawn_arm(p, kArms, 4711, [&](const Parameters& arm) {
    const Trial trial = try_arm(p, limits, {}, reference_trajectory(), arm);
    const auto inside = [&](double part) {
      return trial.link[0] <= part * r.link[0] && trial.link[1] <= part * r.link[1];
    };
    within += inside(1) ? 1 : 0;
    within_half += inside(0.5) ? 1 : 0;
  });
  EXPECT_GE(within, 0.99 * kArms - 3 * std::sqrt(0.01 * 0.99 * kArms));  // three standard deviations of such a count
  EXPECT_LT(within_half, 0.99 * kArms);                                  // tubes of half the width would not do
  EXPECT_LT(r.first_order, r.ellipsoid);  // all times and limits at once take less than all parameters at once
}

INSTANTIATE_TEST_SUITE_P(Errors, RobustTrial, testing::Values(1e-4, 1e-2));

TEST(Robustness, TellsTheLimitThatLacksItsMarginAndWhoseErrorItIs) {
  Parameters p = uncertain(robot(), 1e-9);
  Uncertainty u = *p.uncertainty;
  u.covariance(2, 2) = std::pow(0.01 * p.spring.stiffness[0], 2);
  p.uncertainty = std::make_shared<const Uncertainty>(u);
  Limits limits = robot_limits();
  const Robustness wide = robustness(p, limits, {}, reference_trajectory(), 0.9);
  EXPECT_TRUE(wide.kept) << wide.reason;
  EXPECT_EQ(wide.costs.front().first, "spring.stiffness[0]");
  const auto deflection = std::find_if(wide.limits.begin(), wide.limits.end(), [](const Robustness::Margin& m) {
    return m.name == "spring_deflection" && m.joint == 1;
  });
  ASSERT_NE(deflection, wide.limits.end());
  EXPECT_EQ(deflection->parameter, "spring.stiffness[0]");
  limits.spring_deflection[0] -= deflection->there - 0.5 * deflection->needed;
  const Robustness narrow = robustness(p, limits, {}, reference_trajectory(), 0.9);
  EXPECT_FALSE(narrow.kept);
  EXPECT_THAT(narrow.reason, HasSubstr("spring_deflection of joint 1 needs a margin of "));
  Certificate certificate;
  certificate.certified = true;
  demand_robustness(p, limits, {}, reference_trajectory(), 0.9, certificate);
  EXPECT_FALSE(certificate.certified);
  EXPECT_EQ(certificate.failures, std::vector{narrow.reason});
}

// Half widths of the tubes, and how far an arm is off the plan, of the links and of what its state alone limits.
struct Tube {
  const std::vector<double>* half;
  double (*value)(const State<double>& x, std::size_t joint);
  std::size_t joint;
};

std::vector<Tube> tubes_of(const Robustness& r) {
  std::vector<Tube> tubes;
  for (std::size_t j = 0; j < kJoints; ++j) {
    tubes.push_back({&r.link_tube[j], [](const State<double>& x, std::size_t i) { return x.q[i]; }, j});
  }
  for (const Robustness::Margin& m : r.limits) {
    const auto j = static_cast<std::size_t>(m.joint - 1);
    if (m.name == "motor_velocity") {
      tubes.push_back({&m.tube, [](const State<double>& x, std::size_t i) { return x.dtheta[i]; }, j});
    }
    if (m.name == "spring_deflection") {
      tubes.push_back({&m.tube, [](const State<double>& x, std::size_t i) { return x.theta[i] - x.q[i]; }, j});
    }
  }
  return tubes;
}

// The most that an arm is off the plan, in half widths of the tubes, at the times that tubes are told for.
double largest_in_tubes(const Parameters& robot, const Robustness& r, const Parameters& arm) {
  const std::vector<Tube> tubes = tubes_of(r);
  Interpolator plan(reference_trajectory());
  double largest = 0;
  roll_out_ticks(robot, arm, reference_trajectory(), start_on(robot, arm, reference_trajectory()),
                 [&](const SimulatedTick& tick) {
                   const auto near = std::lower_bound(r.times.begin(), r.times.end(), tick.end - 1e-9);
                   if (near == r.times.end() || std::abs(*near - tick.end) > 1e-9) return;
                   const auto at = static_cast<std::size_t>(near - r.times.begin());
                   const State<double> planned = plan.at(tick.end).state;
                   for (const Tube& tube : tubes) {
                     const double off = tube.value(tick.state, tube.joint) - tube.value(planned, tube.joint);
                     largest = std::max(largest, std::abs(off) / (*tube.half)[at]);
                   }
                 });
  return largest;
}

TEST(Robustness, WhatIsStoppedIsNotEvaluated) {
  int asked = 0;
  const auto stopped = [&] { return ++asked > 3; };
  const Robustness r =
      robustness(uncertain(robot(), 0.01), robot_limits(), {}, reference_trajectory(), 0.9, one_after_another, stopped);
  EXPECT_FALSE(r.evaluated || r.kept);
}

// Arms that nobody had seen when the tubes were made; half of their width holds far fewer (measured: all, and 46 of
// 200).
TEST(Robustness, TubesHoldTheStatedFractionOfArmsAtAllTimes) {
  constexpr double kConfidence = 0.9;
  constexpr int kArms = 200;
  const Parameters p = uncertain(robot(), 0.01);
  const Robustness r = robustness(p, robot_limits(), {}, reference_trajectory(), kConfidence);
  ASSERT_EQ(tubes_of(r).size(), 6U);
  ASSERT_GT(r.times.size(), 100U);
  int inside = 0, in_half = 0;
  each_drawn_arm(p, kArms, 2024, [&](const Parameters& arm) {
    const double largest = largest_in_tubes(p, r, arm);
    inside += largest <= 1 ? 1 : 0;
    in_half += largest <= 0.5 ? 1 : 0;
  });
  EXPECT_GE(inside, kArms * (kConfidence - 3 * std::sqrt(kConfidence * (1 - kConfidence) / kArms)));
  EXPECT_LT(in_half, kArms * 0.8);
}

TEST(Robustness, IsTheSameOnSeveralThreads) {
  const Parameters p = uncertain(robot(), 1e-3);
  const auto threads = [](std::size_t count, const auto& task) { for_each_index(count, 3, task); };
  EXPECT_EQ(robustness(p, robot_limits(), {}, reference_trajectory(), 0.8).link,
            robustness(p, robot_limits(), {}, reference_trajectory(), 0.8, threads).link);
}

// The share of arms, others than those that margins were found by, that keep everything.
double kept_by(const Problem& problem, const Plan& plan, int arms) {
  int kept = 0;
  each_drawn_arm(problem.robot, arms, 4711, [&](const Parameters& arm) {
    kept += try_arm(problem.robot, problem.limits, {}, *plan.trajectory, arm).kept ? 1 : 0;
  });
  return static_cast<double>(kept) / arms;
}

TEST(RobustPlan, LeavesMarginsForArmsThatItHasNotSeen) {
  const Parameters p = uncertain(robot(), 0.01);
  const std::string move = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.0, 0.5]}\n";
  const Problem ordinary = parse_request(move, "move.yaml", p),
                robust = parse_request(move + "robust: {confidence: 0.9}\n", "move.yaml", p);
  const Plan without = plan(ordinary, {}), with = plan(robust, {});
  ASSERT_EQ(with.status, PlanStatus::kCertified) << with.reason;
  const Robustness& r = with.certificate->robustness;
  EXPECT_TRUE(r.kept);
  for (const Robustness::Margin& m : r.limits) EXPECT_GE(m.there, m.needed) << m.name << " " << m.joint;
  ASSERT_TRUE(r.price);
  EXPECT_NEAR(*r.price, with.objective - without.objective, 1e-9);
  EXPECT_GT(*r.price, 0);
  EXPECT_LT(*r.price, 0.05 * without.objective);
  EXPECT_EQ(r.savings.size(), r.names.size());
  EXPECT_GT(r.savings.front().second, 0);
  EXPECT_LT(r.savings.front().second, *r.price);
  // The first is told by planning again: a new request with half that error comes to the same.
  Uncertainty better = *p.uncertainty;
  const auto first = std::find(better.names.begin(), better.names.end(), r.savings.front().first);
  const auto i = static_cast<Eigen::Index>(first - better.names.begin());
  ASSERT_EQ((better.covariance.col(i).array() != 0).count(), 1) << "told of one that is correlated with others";
  better.covariance(i, i) /= 4;
  Problem known = robust;
  known.robot.uncertainty = std::make_shared<const Uncertainty>(std::move(better));
  EXPECT_NEAR(r.savings.front().second, with.objective - plan(known, {}).objective, 1e-9);
  constexpr int kArms = 200;
  EXPECT_GE(kept_by(robust, with, kArms), 0.9 - 3 * std::sqrt(0.9 * 0.1 / kArms));  // three standard deviations
  EXPECT_LT(kept_by(ordinary, without, kArms), 0.5);
  EXPECT_FALSE(without.certificate->robustness.evaluated);
}

// With half its error the payload is still what is uncertain, and margins are found for it.
TEST(RobustPlan, OfAnUncertainPayloadTellsWhatHalfItsErrorSaves) {
  const Problem problem = parse_request(
      "start: {q: [0.3, 0.2]}\ngoal: {q: [0.0, 0.5]}\n"
      "payload: {value: 0.1, unit: kg, standard_error: 0.01}\nrobust: {confidence: 0.9}\n",
      "loaded.yaml", robot());
  const Plan with = plan(problem, {});
  ASSERT_EQ(with.status, PlanStatus::kCertified) << with.reason;
  const Robustness& r = with.certificate->robustness;
  ASSERT_FALSE(r.savings.empty());
  EXPECT_EQ(r.savings.front().first, "payload.mass");
  EXPECT_GT(r.savings.front().second, 0);
  EXPECT_LT(r.savings.front().second, *r.price);
}

// A motion that was certified, but has no margins when the time is over, is none.
TEST(RobustPlan, IsNotWhatADeadlineLeavesWithoutMargins) {
  const Problem problem = parse_request(
      "start: {q: [0.3, 0.2]}\ngoal: {q: [0.0, 0.5]}\n"
      "payload: {value: 0.1, unit: kg, standard_error: 0.01}\nrobust: {confidence: 0.9}\n",
      "loaded.yaml", robot());
  PlanOptions options;
  options.jobs = 1;
  const Plan whole = plan(problem, options);
  ASSERT_EQ(whole.status, PlanStatus::kCertified) << whole.reason;
  ASSERT_GT(*whole.certificate->robustness.price, 0);  // margins had to be made
  options.deadline = 1.2 * whole.timing.at("total");
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.deadline + 0.1);
  bool held_up = false;
  options.on_progress = [&](const Progress& progress) {
    if (progress.phase != Phase::kMargins) return;
    held_up = true;
    std::this_thread::sleep_until(end);
  };
  const Plan cut = plan(problem, options);
  EXPECT_TRUE(held_up);
  EXPECT_EQ(cut.status, PlanStatus::kDeadline) << cut.reason;
  EXPECT_FALSE(cut.trajectory || cut.solution);
}

// The share of arms, others than those that margins were found by, that stay within the tolerance of the lines through
// these corners: by their distance from the nearest of them.
double near_lines(const Problem& problem, const Trajectory& trajectory, int arms) {
  const JointPath& path = *problem.task.path;
  const auto distance = [&](const Joints<double>& q) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < path.corners.size(); ++i) {
      const Eigen::Vector2d from(path.corners[i].data()), way = Eigen::Vector2d(path.corners[i + 1].data()) - from;
      const Eigen::Vector2d off = Eigen::Vector2d(q.data()) - from;
      const double along = std::clamp(off.dot(way) / way.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (off - along * way).norm());
    }
    return least;
  };
  int near = 0;
  each_drawn_arm(problem.robot, arms, 4711, [&](const Parameters& arm) {
    double largest = 0;
    const bool completed =
        roll_out_ticks(problem.robot, arm, trajectory, start_on(problem.robot, arm, trajectory),
                       [&](const SimulatedTick& tick) { largest = std::max(largest, distance(tick.state.q)); });
    near += completed && largest <= path.tolerance ? 1 : 0;
  });
  return static_cast<double>(near) / arms;
}

// Where a path is active nearly all the way, what keeps its margins cannot be had from the multipliers of what does
// not. These are wider than a line reaches beyond its ends: at the corner an arm that is ahead or behind is near the
// other line.
TEST(RobustPlan, LeavesMarginsAlongAPath) {
  const std::string request =
      "start: {q: [0.0, 0.0]}\ngoal: {q: [0.4, -0.1]}\npath: {points: [[0.2, 0.1]], tolerance: 0.002}\n"
      "payload: {value: 0.05, unit: kg, standard_error: 0.0005}\n";
  const Problem ordinary = parse_request(request, "path.yaml", robot()),
                robust = parse_request(request + "robust: {confidence: 0.9}\n", "path.yaml", robot());
  const Plan without = plan(ordinary, {}), with = plan(robust, {});
  ASSERT_EQ(without.status, PlanStatus::kCertified) << without.reason;
  ASSERT_EQ(with.status, PlanStatus::kCertified) << with.reason;
  double widest = 0;
  for (const Robustness::Margin& m : with.certificate->robustness.task) {
    EXPECT_GE(m.there, m.needed) << m.name;
    widest = std::max(widest, *std::max_element(m.tube.begin(), m.tube.end()));
  }
  EXPECT_GT(widest, 0.14 * robust.task.path->tolerance);  // what a line reaches beyond its ends
  constexpr int kArms = 200;
  EXPECT_GE(near_lines(robust, *with.trajectory, kArms), 0.9 - 3 * std::sqrt(0.9 * 0.1 / kArms));
  EXPECT_LT(near_lines(ordinary, *without.trajectory, kArms), 0.5);
}

TEST(Robustness, OfATrajectoryShorterThanAnyTickIsThatOfOneTick) {
  Trajectory brief = resting({0.3, 0.2}, 1e-3);
  brief.samples.back().time = 1e-13;
  EXPECT_TRUE(robustness(uncertain(robot(), 1e-9), robot_limits(), {}, brief, 0.9).kept);
}

TEST(Robustness, OfAnArmThatIsKnownExactlyIsRefused) {
  EXPECT_THROW(robustness(robot(), robot_limits(), {}, reference_trajectory(), 0.99), InputError);
}

}  // namespace
}  // namespace fjr
