// Published rows against the motion they were taken from: where they lie, what they hold, and what chords between them
// lose of the torque's impulse.
#include "planner/ocp/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "model/friction.h"
#include "planner/search/publication.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

const Parameters& robot() {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  return p;
}

Problem problem() {
  Problem p;
  p.robot = robot();
  p.limits.torque = {12, 5};
  p.sample_period = 0.001;
  return p;
}

// A motion with given node times: dtheta1 = 2 - 14 t (reverses at 1/7 s), dtheta2 = -1 + 9 t (at 1/9 s), the links
// slow; u linear on every interval and jumping at the nodes. It obeys no dynamics: sampling does not ask for them.
Motion made(const std::vector<double>& nodes) {
  Motion motion;
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const double t = nodes[k], h = nodes[k + 1] - nodes[k];
    Motion::Interval interval{t, h, Eigen::MatrixXd::Zero(kStates, 3), Eigen::MatrixXd::Zero(kControls, 2)};
    interval.state << 0.1 + 0.2 * t, 0.2 * h, 0,          // q1
        -0.3 * t, -0.3 * h, 0,                            // q2
        0.2, 0, 0, -0.3, 0, 0,                            // dq
        2 * t - 7 * t * t, (2 - 14 * t) * h, -7 * h * h,  // theta1
        -t + 4.5 * t * t, (-1 + 9 * t) * h, 4.5 * h * h,  // theta2
        2 - 14 * t, -14 * h, 0, -1 + 9 * t, 9 * h, 0;     // dtheta
    const double jump = k % 2 == 0 ? 1 : -1;
    interval.torque << 3 * jump, 20 * h, 2 * jump, -10 * h;
    motion.intervals.push_back(interval);
  }
  return motion;
}

std::vector<double> uneven_nodes() { return {0, 0.0313, 0.0655, 0.1001, 0.14217, 0.1777, 0.2, 0.2345}; }

Joints<double> exact_torque(const Motion& motion, std::size_t interval, double time) {
  Joints<double> tau = motion.torque_in(interval, time);
  const State<double> x = motion.state_in(interval, time);
  for (int j = 0; j < kJoints; ++j) {
    tau[static_cast<std::size_t>(j)] += FrictionLaw::of(robot(), j).nonlinear(x.dtheta[static_cast<std::size_t>(j)]);
  }
  return tau;
}

bool is_multiple(double time, double period) {
  return std::abs(time - std::round(time / period) * period) < 1e-12;  // times below 1 s: roundings
}

// The trapezoidal rule's velocities are parabolas beside the straight lines that its positions have as derivatives.
// Here they are faster by 0.1 c (1 - c) [rad/s] in all but the first two intervals: sums of these do not cancel.
Motion of_order_2() {
  Motion motion = made(uneven_nodes());
  for (std::size_t k = 2; k < motion.intervals.size(); ++k) {
    for (const int row : {2, 3, 6, 7}) {
      motion.intervals[k].state(row, 1) += 0.1;
      motion.intervals[k].state(row, 2) -= 0.1;
    }
  }
  return motion;
}

// The mean of 0.1 c (1 - c) is 0.1 / 6. What the integrals miss the end of a segment by is taken off evenly.
TEST(Sampling, PositionsOfAMotionOfOrderTwoBecomeIntegralsOfItsVelocities) {
  const Motion before = of_order_2();
  Mesh mesh;  // segments from 0 to 0.1001 s and from there on
  for (std::size_t k = 0; k < before.intervals.size(); ++k) mesh.intervals.push_back({0, k < 3 ? 0 : 1});
  const Motion after = with_integrated_positions(before, mesh);
  const double slower[] = {0.1 / 6 * (0.1001 - 0.0655) / 0.1001, 0.1 / 6};  // [rad/s]
  for (std::size_t k = 0; k < before.intervals.size(); ++k) {
    const double start = before.intervals[k].start, h = before.intervals[k].duration, step = 1e-3 * h;
    for (const double time : {start + 0.01 * h, start + 0.3 * h, start + 0.9 * h}) {
      const State<double> here = after.state_in(k, time), was = before.state_in(k, time),
                          next = after.state_in(k, time + step), last = after.state_in(k, time - step);
      for (std::size_t j = 0; j < kJoints; ++j) {
        EXPECT_EQ(here.dq[j], was.dq[j]);
        EXPECT_EQ(here.dtheta[j], was.dtheta[j]);
        // A difference quotient of a cubic whose third derivative is 0.2 / h^2 rad/s^3 is off by 3e-8 rad/s.
        EXPECT_NEAR((next.q[j] - last.q[j]) / (2 * step), here.dq[j] - slower[mesh.intervals[k].segment], 1e-7);
        EXPECT_NEAR((next.theta[j] - last.theta[j]) / (2 * step), here.dtheta[j] - slower[mesh.intervals[k].segment],
                    1e-7);
      }
    }
    if (k + 1 == before.intervals.size()) break;
    const State<double> ends = after.state_in(k, start + h), begins = after.state_in(k + 1, start + h);
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(ends.theta[j], begins.theta[j], 1e-15) << k;  // roundings
  }
  for (const std::size_t k : {std::size_t{0}, std::size_t{3}}) {  // where a segment begins
    EXPECT_EQ(after.intervals[k].state(kStateQ, 0), before.intervals[k].state(kStateQ, 0));
  }
  const double end = before.duration();
  EXPECT_NEAR(after.state_at(end).theta[1], before.state_at(end).theta[1], 1e-15);
}

TEST(Sampling, RowsIncreaseAndReachFromStartToEnd) {
  const Motion motion = made(uneven_nodes());
  const auto rows = sample(problem(), motion).samples;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) EXPECT_LT(rows[i].time, rows[i + 1].time);
  EXPECT_EQ(rows.front().time, 0);
  EXPECT_EQ(rows.back().time, motion.duration());
  const State<double> first = motion.state_in(0, 0), last = motion.state_in(6, motion.duration());
  for (int i = 0; i < kStates; ++i) {
    EXPECT_NEAR(rows.front().state[i], first[i], 1e-14);  // velocities are those of the positions, but for roundings
    EXPECT_NEAR(rows.back().state[i], last[i], 1e-14);
  }
}

TEST(Sampling, EveryMultipleOfThePeriodHasARowAndTheRestArePairs) {
  const Motion motion = made(uneven_nodes());
  const auto rows = sample(problem(), motion).samples;
  int multiples = 0;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    if (is_multiple(rows[i].time, 0.001)) {
      ++multiples;
      continue;
    }
    const double spacing = std::min(rows[i].time - rows[i - 1].time, rows[i + 1].time - rows[i].time);
    EXPECT_GT(spacing, kJumpSpacing - 1e-12) << rows[i].time;
    EXPECT_LT(spacing, 1e-5 + 1e-12) << rows[i].time;  // to both sides of a reversal
  }
  EXPECT_EQ(multiples, 235);  // 0 .. 0.234; the end is at 0.2345
}

TEST(Sampling, RowsHoldTheStateAndTorqueOfTheMotion) {
  const Motion motion = made(uneven_nodes());
  for (const Sample& row : sample(problem(), motion).samples) {
    std::size_t k = motion.interval_at(row.time);
    if (k > 0 && row.time - motion.intervals[k].start < 0.4 * kJumpSpacing) --k;
    const State<double> x = motion.state_in(k, row.time);
    for (int i = 0; i < kStates; ++i) EXPECT_NEAR(row.state[i], x[i], 1e-13) << row.time;
    Joints<double> tau = exact_torque(motion, k, row.time);
    if (k + 1 < motion.intervals.size() && std::abs(motion.intervals[k + 1].start - row.time) < 0.4 * kJumpSpacing) {
      const Joints<double> after = exact_torque(motion, k + 1, row.time);  // rows at a node hold the middle of the jump
      for (std::size_t j = 0; j < kJoints; ++j) tau[j] = 0.5 * (tau[j] + after[j]);
    }
    // A rounding of dtheta (1e-16 rad/s) times the steepest slope of the friction law (5,500 N m s/rad).
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(row.torque[j], tau[j], 1e-11) << row.time;
  }
}

TEST(Sampling, TorqueIsHeldToItsLimits) {
  Motion motion = made(uneven_nodes());
  for (auto& interval : motion.intervals) interval.torque *= 5;  // up to 15 N m
  bool reached = false;
  for (const Sample& row : sample(problem(), motion).samples) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_LE(std::abs(row.torque[j]), problem().limits.torque[j]);
      reached = reached || std::abs(row.torque[j]) == problem().limits.torque[j];
    }
  }
  EXPECT_TRUE(reached);
}

// The rows on both sides of `node`, where they are near; otherwise nothing.
std::vector<Sample> pair_at(const std::vector<Sample>& rows, double node) {
  std::vector<Sample> near;
  for (const Sample& row : rows) {
    const double away = std::abs(row.time - node);
    if (away > 0.4 * kJumpSpacing && away < 1.5 * kJumpSpacing) near.push_back(row);
  }
  return near;
}

TEST(Sampling, JumpsAtNodesBecomePairs) {
  const auto nodes = uneven_nodes();
  const Motion motion = made(nodes);
  const auto rows = sample(problem(), motion).samples;
  for (std::size_t k = 1; k + 1 < nodes.size(); ++k) {  // 0.2 is a multiple of the period as well
    const auto pair = pair_at(rows, nodes[k]);
    ASSERT_EQ(pair.size(), 2u) << nodes[k];
    const Joints<double> before = exact_torque(motion, k - 1, nodes[k]), after = exact_torque(motion, k, nodes[k]);
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_NEAR(pair[0].torque[j], before[j], 1e-3);  // u and friction change by less in a microsecond
      EXPECT_NEAR(pair[1].torque[j], after[j], 1e-3);
    }
  }
}

// What is wanted between two times: int of u + exact friction, by a fine midpoint rule between the nodes.
Joints<double> impulse(const Motion& motion, double from, double to, int pieces = 2000) {
  Joints<double> sum{0, 0};
  double at = from;
  for (std::size_t k = motion.interval_at(from); at < to; ++k) {
    const double node = k + 1 < motion.intervals.size() ? std::min(motion.intervals[k + 1].start, to) : to;
    // 2000 of half a microsecond, in which friction crosses a twentieth of its step
    const double h = (node - at) / pieces;
    for (int i = 0; i < pieces && h > 0; ++i) {
      const Joints<double> tau = exact_torque(motion, k, at + (i + 0.5) * h);
      for (std::size_t j = 0; j < kJoints; ++j) sum[j] += h * tau[j];
    }
    at = std::max(node, at);
  }
  return sum;
}

// Largest velocity error [rad/s] that the chords make of a motor in any one period, and over the whole motion.
struct Missed {
  double in_a_period = 0, in_all = 0;
};

Missed missed(const Motion& motion, double velocity_error = kRowVelocityError, int pieces = 2000) {
  const auto rows = sample(problem(), motion, velocity_error).samples;
  Missed missed;
  Joints<double> total{0, 0}, period{0, 0};
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const double h = rows[i + 1].time - rows[i].time;
    const Joints<double> wanted = impulse(motion, rows[i].time, rows[i + 1].time, pieces);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double miss = 0.5 * h * (rows[i].torque[j] + rows[i + 1].torque[j]) - wanted[j];
      period[j] += miss / robot().motor.inertia[j];
      total[j] += miss / robot().motor.inertia[j];
      missed.in_a_period = std::max(missed.in_a_period, std::abs(period[j]));
    }
    if (is_multiple(rows[i + 1].time, 0.001)) period = {0, 0};
  }
  missed.in_all = std::max(std::abs(total[0]), std::abs(total[1]));
  return missed;
}

// sampling.cc promises 1e-4 rad/s a piece; a period with a reversal and a jump in it has several. Measured: 2.7e-4 in
// the worst period, 2.1e-4 in all; one jump missed makes 2.7e-3.
constexpr double kMissed = 4e-4;

TEST(Sampling, ChordsCarryTheImpulseOfTheTorque) {
  const Missed m = missed(made(uneven_nodes()));
  EXPECT_LT(m.in_a_period, kMissed);
  EXPECT_LT(m.in_all, kMissed);  // two reversals, six jumps, and nothing to speak of in between
}

// At full torque a motor reverses with 175 rad/s^2: friction takes its step of 1.6 N m within two microseconds,
// wherever between two rows. Measured: 2e-6 rad/s; without looking for the reversal 1e-4 to 2.4e-4, however fine the
// rows.
TEST(Sampling, AFastReversalIsFoundExactly) {
  constexpr double kFast = 175, kLength = 0.004;  // [rad/s^2], [s]
  for (const double reversal : {0.00131, 0.001499, 0.0016627, 0.0019035, 0.0025003}) {
    Motion motion;
    Motion::Interval interval{0, kLength, Eigen::MatrixXd::Zero(kStates, 3), Eigen::MatrixXd::Zero(kControls, 2)};
    interval.state.row(4) << 0, kFast * reversal * kLength, -kFast / 2 * kLength * kLength;
    interval.state.row(6) << kFast * reversal, -kFast * kLength, 0;
    motion.intervals.push_back(interval);
    EXPECT_LT(missed(motion, 1e-6, 20000).in_all, 3e-5) << reversal;
  }
}

// A motor that leaves its rest with 79 rad/s^2, or comes to it, has friction's first step, of 0.8 N m, within three
// microseconds of the end of its interval. Measured: at most 1e-5 rad/s; without a row beside the rest 1.0e-4
// and 1.3e-4.
TEST(Sampling, AStartFromRestAndAStopKeepTheImpulse) {
  constexpr double kFast = 79, kLength = 0.0032;  // [rad/s^2], [s]
  for (const double begin : {0.0, -kFast * kLength}) {
    Motion motion;
    Motion::Interval interval{0, kLength, Eigen::MatrixXd::Zero(kStates, 3), Eigen::MatrixXd::Zero(kControls, 2)};
    interval.state.row(4) << 0, begin * kLength, kFast / 2 * kLength * kLength;
    interval.state.row(6) << begin, kFast * kLength, 0;
    motion.intervals.push_back(interval);
    EXPECT_LT(missed(motion, 1e-6, 20000).in_all, 3e-5) << begin;
  }
}

// Fixed durations put nodes onto multiples of the sample period, up to rounding and up to a fraction of a jump's
// spacing.
TEST(Sampling, ChordsCarryTheImpulseWhenNodesFallOnRows) {
  for (const double offset :
       {0.0, 1e-17, 1e-15, -1e-15, 1e-13, -1e-13, 2e-7, -2e-7, 4e-7, -4e-7, 9e-7, -9e-7, 2e-6, -2e-6}) {
    std::vector<double> nodes;
    for (int k = 0; k <= 8; ++k) nodes.push_back(0.03 * k + (k > 0 && k < 8 ? offset : 0));
    const Missed m = missed(made(nodes));
    EXPECT_LT(m.in_a_period, kMissed) << offset;
    EXPECT_LT(m.in_all, kMissed) << offset;
  }
}

// u climbs within every interval and falls back at every node, as it does where an objective leaves it undetermined:
// what chords miss at one jump adds up over all of them.
TEST(Sampling, JumpsOnRowsAreNeitherEarlyNorLate) {
  std::vector<double> nodes;
  for (int k = 0; k <= 60; ++k) nodes.push_back(0.01 * k);
  Motion motion = made(nodes);
  for (auto& interval : motion.intervals) {
    interval.state.bottomRows(4).setZero();  // theta, dtheta = 1: with any other, friction would bend the chords
    interval.state.block(4, 0, 2, 2) << interval.start, interval.duration, interval.start, interval.duration;
    interval.state(6, 0) = interval.state(7, 0) = 1;
    interval.torque << 0, 6, 0, 2;
  }
  // Of each half a microsecond late it would be 59 * 2 N m * 5e-7 s / 0.0145 kg m^2 = 4.1e-3 rad/s.
  EXPECT_LT(missed(motion).in_all, 1e-6);
}

TEST(Sampling, IsTheSameToTheBitTheSecondTime) {
  const Motion motion = made(uneven_nodes());
  const auto a = sample(problem(), motion).samples, b = sample(problem(), motion).samples;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].time, b[i].time);
    EXPECT_EQ(a[i].torque, b[i].torque);
  }
}

// Rows that were made finer where the torque asks for it are farther apart elsewhere, rather than too many.
TEST(Rows, LieFartherApartWhereThereWouldBeTooMany) {
  const Motion motion = made(uneven_nodes());
  const std::size_t usual = rows_of(problem(), motion, kRowVelocityError).samples.size();
  EXPECT_EQ(usual, sample(problem(), motion).samples.size());
  const Trajectory fewer = rows_of(problem(), motion, kRowVelocityError, usual - 1);
  EXPECT_LT(fewer.samples.size(), usual);
  EXPECT_EQ(fewer.end_time(), motion.duration());
  Problem asked = problem();
  asked.longest_sample_period = asked.sample_period;
  EXPECT_EQ(rows_of(asked, motion, kRowVelocityError, usual - 1).samples.size(), usual)
      << "their distance is asked for";
}

}  // namespace
}  // namespace fjr
