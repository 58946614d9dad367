// Error estimates on motions that the schemes themselves produced, the bookkeeping of splitting, and margins.
#include "planner/search/refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>

#include "planner/ocp/collocate.h"
#include "planner/ocp/margins.h"
#include "planner/problem/task/task.h"
#include "planner/trajectory/motion.h"
#include "tests/support/arbitrary.h"
#include "tests/support/plants.h"

namespace fjr {
namespace {

using Vector8 = Eigen::Matrix<double, kStates, 1>;

const Parameters& robot() {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  return p;
}

// The collocation solution of an initial value problem on equal steps, u linear in time throughout: stages by fixed
// point iteration (the steps are short enough to contract).
Motion simulated(const Scheme& scheme, int steps, double duration) {
  const auto torque = [&](double t) { return Joints<double>{2 - 3 * t / duration, -0.5 + 1.5 * t / duration}; };
  Motion motion;
  const State<double> start = rest_at(robot(), {0.2, -0.3});
  Vector8 node;
  start.copy_to(node.data());
  const double h = duration / steps;
  for (int k = 0; k < steps; ++k) {
    Eigen::Matrix<double, kStates, Eigen::Dynamic> y = node.replicate(1, scheme.stages()), f = y;
    for (int iteration = 0; iteration < 100; ++iteration) {
      for (int j = 0; j < scheme.stages(); ++j) {
        const Vector8 stage = y.col(j);
        const auto rate =
            compensated_dynamics(robot(), State<double>::from(stage.data()), torque(h * (k + scheme.points(j))));
        rate.copy_to(f.col(j).data());
      }
      y = node.replicate(1, scheme.stages()) + h * f * scheme.A.transpose();
    }
    Motion::Interval interval{k * h, h, Eigen::MatrixXd::Zero(kStates, scheme.stages() + 1),
                              Eigen::MatrixXd::Zero(kControls, 2)};
    interval.state.col(0) = node;
    for (int d = 0; d < scheme.stages(); ++d) interval.state.col(d + 1) = h / (d + 1) * f * scheme.lagrange.col(d);
    const Joints<double> begin = torque(k * h), end = torque((k + 1) * h);
    interval.torque << begin[0], end[0] - begin[0], begin[1], end[1] - begin[1];
    motion.intervals.push_back(interval);
    node = y.col(scheme.stages() - 1);
  }
  return motion;
}

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

class Errors : public testing::TestWithParam<Scheme> {};

TEST_P(Errors, FallWithTheOrderPlusOneWhenIntervalsAreHalved) {
  const Scheme& scheme = GetParam();
  constexpr double kDuration = 0.16;
  const double coarse = largest(interval_errors(robot(), simulated(scheme, 16, kDuration)));
  const double fine = largest(interval_errors(robot(), simulated(scheme, 32, kDuration)));
  // The estimate's own integration (classical Runge-Kutta in eight substeps, local order 5) is all that is seen of a
  // method of order 6.
  // 0.2: what the next power of h leaves at these lengths (measured: at most 0.13).
  EXPECT_NEAR(std::log2(coarse / fine), scheme.order == 6 ? 5 : scheme.order + 1, 0.2) << coarse << " -> " << fine;
}

INSTANTIATE_TEST_SUITE_P(All, Errors, testing::ValuesIn(all_schemes()),
                         [](const auto& test) { return identifier(test.param.name); });

TEST(Errors, SeeADefectOfAKnownSize) {
  Motion motion = simulated(hermite_simpson(), 32, 0.16);
  motion.intervals[5].state(0, 1) += 1e-3;  // q1 at the end of interval 5
  motion.intervals[9].state(7, 1) -= 0.2;   // dtheta2 at the end of interval 9
  const std::vector<double> errors = interval_errors(robot(), motion);
  EXPECT_NEAR(errors[5], 1e-3, 1e-6);  // up to the interval's own error
  EXPECT_NEAR(errors[9], 0.2 * kErrorTime, 1e-6);
}

TEST(Errors, SizeIsTheLargestPositionOrVelocityTimesItsTime) {
  EXPECT_EQ(error_size({{1e-3, -2e-3}, {0, 0}, {0, 1e-3}, {0, 0}}), 2e-3);
  EXPECT_EQ(error_size({{0, 0}, {0.1, 0}, {0, 0}, {-0.4, 0}}), 0.4 * kErrorTime);
}

// ---- splitting ----

TEST(Pieces, FollowTheErrorTheOrderAndTheShortestInterval) {
  Motion motion;
  for (const double duration : {0.1, 0.1, 0.1, 0.1, 0.1, 0.01, 0.005}) {
    motion.intervals.push_back({0, duration, Eigen::MatrixXd::Zero(kStates, 1), Eigen::MatrixXd::Zero(kControls, 1)});
  }
  constexpr double kTolerance = 1e-6;
  constexpr int kOrder = 4;  // two pieces divide an interval's error by 2^5
  const std::vector<double> errors{0, kTolerance, 2 * kTolerance, 31 * kTolerance, 33 * kTolerance, 1e-3, 1e-3};
  EXPECT_EQ(pieces_wanted(motion, errors, kTolerance, kOrder, 0.004), (std::vector<int>{1, 1, 2, 2, 4, 2, 1}));
}

TEST(Cuts, LieOnBothSidesOfTheReversal) {
  Motion motion = simulated(hermite_simpson(), 1, 0.02);
  for (const double share : {0.05, 0.31, 0.77}) {
    auto& velocity = motion.intervals[0].state;  // of motor 1: a line through zero at `share`
    velocity.row(6).setZero();
    velocity(6, 0) = -share;
    velocity(6, 1) = 1;
    const auto found = reversal_in(motion, 0, 0);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, share, 1e-8);
    std::vector<double> cuts{0.3, 0.5};  // the first lies too near to the second reversal
    cut_around(cuts, *found, 0.0125);
    EXPECT_TRUE(std::is_sorted(cuts.begin(), cuts.end()));
    const auto after = std::upper_bound(cuts.begin(), cuts.end(), share);
    ASSERT_TRUE(after != cuts.begin() && after != cuts.end());
    EXPECT_NEAR(*after - *(after - 1), 0.05, 1e-12);
    EXPECT_EQ(cuts.size(), share == 0.31 ? 3U : 4U);
    EXPECT_EQ(split(Mesh{{{1, 0}}}, Cuts{cuts}).size(), cuts.size() + 1);
  }
  motion.intervals[0].state(6, 0) = 1;
  EXPECT_FALSE(reversal_in(motion, 0, 0));
  std::vector<double> none;
  cut_around(none, 0.4, 0.8);  // an interval hardly longer than the shortest stays whole
  EXPECT_TRUE(none.empty());
}

RC_GTEST_PROP(Split, KeepsTheSegmentsWhole, ()) {
  Mesh mesh;
  std::vector<int> pieces;
  const int segments = *rc::gen::inRange(1, 4);
  for (int s = 0; s < segments; ++s) {
    const int intervals = *rc::gen::inRange(1, 30);
    std::vector<double> lengths;
    for (int i = 0; i < intervals; ++i) lengths.push_back(between(0.1, 1));
    const double total = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    for (const double length : lengths) {
      mesh.intervals.push_back({length / total, s});
      pieces.push_back(1 << *rc::gen::inRange(0, 3));
    }
  }
  const Mesh finer = split(mesh, pieces);
  RC_ASSERT(finer.size() == static_cast<std::size_t>(std::accumulate(pieces.begin(), pieces.end(), 0)));
  RC_ASSERT(finer.segments() == segments);
  std::vector<double> sums(static_cast<std::size_t>(segments), 0);
  for (const auto& interval : finer.intervals) sums[static_cast<std::size_t>(interval.segment)] += interval.fraction;
  for (const double sum : sums) RC_ASSERT(std::abs(sum - 1) < 1e-14);  // at most 120 terms
  // Every old node is still a node.
  const std::vector<double> durations(static_cast<std::size_t>(segments), 1.0);
  const auto before = mesh.node_times(durations), after = finer.node_times(durations);
  std::size_t k = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    RC_ASSERT(std::abs(before[i] - after[k]) < 1e-14 * 30);
    k += static_cast<std::size_t>(pieces[i]);
  }
}

// ---- margins ----

Problem limited() {
  Problem problem;
  problem.robot = robot();
  problem.limits.torque = {12, 5};
  problem.limits.motor_velocity = {6, 8};
  problem.limits.spring_deflection = {0.3864, 0.2262};
  return problem;
}

// At rest for 0.1 s: every polynomial zero.
Motion still() {
  Motion motion;
  motion.intervals.push_back({0, 0.1, Eigen::MatrixXd::Zero(kStates, 4), Eigen::MatrixXd::Zero(kControls, 4)});
  return motion;
}

// What the first interval exceeds, in the order of Limits.
Limits excess(const Problem& problem, const Motion& motion) {
  const PerLimit found = excesses(problem, {{{1.0, 0}}}, motion).front();
  Limits limits;
  for (std::size_t i = 0; i < kLimits; ++i) kLimitNames[i].in(limits) = found[i];
  return limits;
}

// What margins.h calls "a part of the base margin" may be kept: at most all of it counts as an excess.
constexpr double kBaseMargins = 12 * kBaseMargin;

TEST(Excesses, AreNoneWellInside) {
  const auto found = excesses(limited(), {{{1.0, 0}}}, still());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0], testing::Each(0));
}

TEST(Excesses, SeeATorqueBeyondItsLimitBetweenTheEnds) {
  Motion motion = still();
  // 11 + 12 c (1 - c) - friction at rest (none): 14 in the middle, 11 at both ends
  motion.intervals[0].torque.row(0) << 11, 12, -12, 0;
  EXPECT_NEAR(excess(limited(), motion).torque[0], 2, kBaseMargins);
  motion.intervals[0].torque.row(0) *= -1;
  EXPECT_NEAR(excess(limited(), motion).torque[0], 2, kBaseMargins);
}

// Motor 1 reverses somewhere within the interval: u = 11.5 is inside on the negative side of the friction step and
// beyond the limit on the positive one, wherever exactly that is.
TEST(Excesses, SeeATorqueAcrossTheFrictionStepWhereverItFalls) {
  const FrictionLaw law = FrictionLaw::of(robot(), 0);
  for (const double crossing : {0.001, 0.31, 0.5, 0.77, 0.999}) {
    Motion motion = still();
    motion.intervals[0].torque.row(0) << 11.5, 0, 0, 0;
    motion.intervals[0].state.row(6) << -0.1 * crossing, 0.1, 0, 0;  // dtheta1 [rad/s]
    const double end = law.nonlinear(0.1 * (1 - crossing));
    const double expected = std::max(0.0, 11.5 + end - 12);
    EXPECT_NEAR(excess(limited(), motion).torque[0], expected, kBaseMargins) << crossing;
  }
}

// u falls just as the friction rises: no probe sees both high together, yet between two of them they may be.
TEST(Excesses, CountTheStepWithTheTorqueOfBothSides) {
  Motion motion = still();
  motion.intervals[0].torque.row(0) << 12, -8, 0, 0;     // 12 -> 4 N m
  motion.intervals[0].state.row(6) << -0.02, 0.6, 0, 0;  // reverses at c = 1/30, between the first two probes
  const double step = FrictionLaw::of(robot(), 0).nonlinear(0.01);  // 0.81 N m, soon after it
  const double found = excess(limited(), motion).torque[0];
  EXPECT_GE(found, 12 - 8.0 / 30 + step - 12 - kBaseMargins);  // what really happens
  EXPECT_LE(found, 12 + 1.1 * step - 12);                      // what the whole step can make at most
}

TEST(Excesses, SeeVelocityDeflectionAndTipSpeed) {
  Problem problem = limited();
  problem.limits.tip_speed = 2;
  Motion motion = still();
  motion.intervals[0].state.row(6) << 0, 4 * 6.5, -4 * 6.5, 0;    // dtheta1 peaks at 6.5
  motion.intervals[0].state.row(5) << 0, -4 * 0.25, 4 * 0.25, 0;  // theta2 - q2 peaks at -0.25
  motion.intervals[0].state.row(2) << 0, 4 * 5.0, -4 * 5.0, 0;    // dq1 peaks at 5: tip at 5 * 0.65 m/s
  const Limits found = excess(problem, motion);
  EXPECT_NEAR(found.motor_velocity[0], 0.5, 6 * kBaseMargin);
  EXPECT_NEAR(found.spring_deflection[1], 0.25 - 0.2262, kBaseMargin);
  EXPECT_NEAR(found.tip_speed, 5 * 0.65 - 2, 2 * kBaseMargin);
  EXPECT_EQ(found.motor_velocity[1], 0);
  EXPECT_EQ(found.link_position[0], 0);  // no limit there
}

TEST(Margins, GrowByTheExcessesAndALittleMore) {
  const Mesh mesh{{{1.0, 0}}};
  Motion motion = still();
  motion.intervals[0].torque.row(0) << 11, 12, -12, 0;
  const auto found = excesses(limited(), mesh, motion);
  std::vector<PerLimit> margins;
  EXPECT_TRUE(widen(margins, found, limited()));
  ASSERT_EQ(margins.size(), 1u);
  EXPECT_GE(margins[0][0], found[0][0]);
  EXPECT_LE(margins[0][0], 1.5 * found[0][0]);
  EXPECT_EQ(margins[0][1], 0);
  const double before = margins[0][0];
  EXPECT_TRUE(widen(margins, found, limited()));
  EXPECT_DOUBLE_EQ(margins[0][0], 2 * before);
  EXPECT_FALSE(widen(margins, excesses(limited(), mesh, still()), limited()));
  EXPECT_DOUBLE_EQ(margins[0][0], 2 * before);
}

// Link 2 swings its tip through a disc between the ends of the interval.
TEST(Excesses, SeeAnObstacleBetweenTheEnds) {
  Problem problem = limited();
  const auto [l1, l2] = problem.robot.link.length;
  const double radius = 0.05, beside = l1 + l2 + 0.03;  // 0.045 m of 0.075 m overlap when it hangs straight
  problem.task.obstacles.discs = {{{0, -beside}, radius, 0}};
  problem.start = rest_at(problem.robot, {-0.5, 0});
  problem.goal.q = {0.5, 0};
  Motion motion = still();
  motion.intervals[0].state.row(0) << -0.5, 1, 0, 0;  // q1 from -0.5 to 0.5
  const PerLimit found = excesses(problem, {{{1.0, 0}}}, motion).front();
  const double apart = radius + problem.robot.link.radius[1];
  const double overlap = (apart * apart - 0.03 * 0.03) / (2 * apart);  // as TaskRow measures it
  EXPECT_NEAR(found[kLimits + 1], overlap, kBaseMargin * apart);
  EXPECT_EQ(found[kLimits], 0);  // link 1 is far away
}

TEST(Margins, AreInheritedByEveryPiece) {
  const std::vector<PerLimit> margins{{0}, {1}, {2}};
  EXPECT_THAT(inherited(margins, {1, 4, 2}), testing::ElementsAre(PerLimit{0}, PerLimit{1}, PerLimit{1}, PerLimit{1},
                                                                  PerLimit{1}, PerLimit{2}, PerLimit{2}));
  EXPECT_TRUE(inherited(std::vector<PerLimit>{}, {1, 2}).empty());
}

}  // namespace
}  // namespace fjr
