#include "planner/identify/replay.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "model/encoder.h"
#include "model/friction.h"
#include "planner/certificate/rollout.h"
#include "planner/control/motor_feedback.h"

namespace fjr {
namespace {

constexpr std::size_t kFewestRows = 30;  // rows of a piece: 120 readings for its 8 unknowns, and some to spare
constexpr std::size_t kFirstRows = 20;   // rows used to guess the initial state of a piece
constexpr int kParkedTicks = 3;          // in a row, so that a motor that only reverses does not count as parked

bool can_be(const Parameters& p) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!(p.spring.stiffness[j] > 0 && p.motor.inertia[j] > 0 && p.friction.width[j] > 0)) return false;
  }
  for (const double q2 : {0.0, std::numbers::pi}) {  // where the determinant of M is smallest
    const MassMatrix<double> m = mass_matrix(p, q2);
    if (!(m.m11 > 0 && m.m11 * m.m22 - m.m12 * m.m12 > 0)) return false;
  }
  return true;
}

// Returns whether between a row and the next any motor's planned velocity is so low that the executor's dither may act.
bool parks(const Parameters& robot, const ExecutedMotion& motion, std::size_t row) {
  if (row + 1 >= motion.times.size()) return false;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double band = kDitherBands * FrictionLaw::of(robot, static_cast<int>(j)).unstable_band();
    const double by = motion.planned_theta[row + 1][j] - motion.planned_theta[row][j];
    if (std::abs(by) < band * (motion.times[row + 1] - motion.times[row])) return true;
  }
  return false;
}

std::vector<bool> parked_rows(const Parameters& robot, const ExecutedMotion& motion) {
  std::vector<bool> parked(motion.times.size(), false);
  int in_a_row = 0;
  for (std::size_t i = 0; i < parked.size(); ++i) {
    in_a_row = parks(robot, motion, i) ? in_a_row + 1 : 0;
    if (in_a_row < kParkedTicks) continue;
    for (int k = 0; k < kParkedTicks; ++k) parked[i - static_cast<std::size_t>(k)] = true;
  }
  return parked;
}

// Fits a parabola to the first readings and returns its position [rad] and velocity [rad/s] at the first row.
std::pair<double, double> begin_of(const ExecutedMotion& motion, const std::vector<Joints<double>>& readings,
                                   std::size_t first, std::size_t joint) {
  Eigen::Matrix<double, kFirstRows, 3> a;
  Eigen::Matrix<double, kFirstRows, 1> b;
  for (std::size_t i = 0; i < kFirstRows; ++i) {
    const double t = motion.times[first + i] - motion.times[first];
    a.row(static_cast<Eigen::Index>(i)) << 1, t, t * t;
    b[static_cast<Eigen::Index>(i)] = readings[first + i][joint];
  }
  const Eigen::Vector3d c = a.householderQr().solve(b);
  return {c[0], c[1]};
}

State<double> state_at(const ExecutedMotion& motion, std::size_t first) {
  State<double> x{};
  for (std::size_t j = 0; j < kJoints; ++j) {
    std::tie(x.q[j], x.dq[j]) = begin_of(motion, motion.q, first, j);
    std::tie(x.theta[j], x.dtheta[j]) = begin_of(motion, motion.theta, first, j);
  }
  return x;
}

}  // namespace

std::vector<ReplayedPiece> pieces_of(const Parameters& robot, const ExecutedMotion& motion, std::size_t index) {
  const std::vector<bool> parked = parked_rows(robot, motion);
  std::vector<ReplayedPiece> pieces;
  for (std::size_t first = 0; first < parked.size();) {
    std::size_t end = first;
    while (end < parked.size() && !parked[end]) ++end;
    const std::size_t rows = end - first;
    const auto parts = static_cast<std::size_t>(std::ceil(static_cast<double>(rows) * kTick / kPiece));
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t from = first + part * rows / parts, count = first + (part + 1) * rows / parts - from;
      if (count >= kFewestRows) pieces.push_back({index, from, count, state_at(motion, from)});
    }
    first = std::max(end, first + 1);
  }
  return pieces;
}

Eigen::Vector4d count_deviation(const Parameters& robot) {
  Eigen::Vector4d deviation;
  for (std::size_t j = 0; j < kJoints; ++j) {
    deviation[static_cast<Eigen::Index>(j)] = count_angle(robot.encoder.link_counts[j]) / std::sqrt(12);
    deviation[static_cast<Eigen::Index>(j + kJoints)] = count_angle(robot.encoder.motor_counts[j]) / std::sqrt(12);
  }
  return deviation;
}

std::optional<Eigen::VectorXd> replayed(const Parameters& robot, const ExecutedMotion& motion,
                                        const ReplayedPiece& piece, const State<double>& start) {
  if (!can_be(robot)) return std::nullopt;
  Eigen::VectorXd positions(4 * static_cast<Eigen::Index>(piece.count));
  State<double> x = start;
  Rollout rollout(robot, Limits{}, Accuracy::of_certificates());
  const double begin = motion.times[piece.first];
  rollout.start(begin, x, Drive::holding({begin, {}, motion.torque[piece.first]}));
  for (std::size_t k = 0; k < piece.count; ++k) {
    positions.segment<4>(4 * static_cast<Eigen::Index>(k)) << x.q[0], x.q[1], x.theta[0], x.theta[1];
    if (k + 1 == piece.count) break;
    rollout.hold(motion.torque[piece.first + k]);
    if (!rollout.run(motion.times[piece.first + k + 1], {}, {}, {})) return std::nullopt;
    x = rollout.state();
  }
  return positions;
}

}  // namespace fjr
