#include "planner/learning/smoothed_run.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/input_error.h"
#include "model/encoder.h"
#include "planner/identify/replay.h"

namespace fjr {
namespace {

// The unknowns per tick: state of the arm, then the lacking torques of links and motors.
constexpr int kLacking = kStates, kUnknowns = kStates + 2 * kJoints, kReadings = 2 * kJoints;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using UnknownsMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Reading = Eigen::Matrix<double, kReadings, 1>;

// Intensity of the random walks, relative to the torque limit of the joint [1/sqrt(s)]. Lacking torques change within
// some tenths of a second, like the motion. With 0.1 to 0.3, ten repetitions on an arm 5 % softer with a payload end at
// errors of 0.4 and 0.9 counts rms of the two links. With 1, the quantisation of the motor encoders is mistaken for
// torques and link 2 stays at 4 counts, with 3 at 16.
constexpr double kWalk = 0.2;
constexpr double kFirstLacking = 0.1;   // of the torque limit, one standard deviation before the first reading
constexpr double kFirstVelocity = 0.1;  // [rad/s] likewise: motions begin at rest, or nearly so
// The quantisation error is constant while the reading is. It is treated as constant for at most so many ticks.
constexpr double kMostAlike = 100;

struct Step {
  Unknowns filtered;
  UnknownsMatrix covariance;  // of it
  UnknownsMatrix transition;  // to the next tick
  UnknownsMatrix kept;        // I - K H: maps a deviation before the measurement update to the one after it
  Unknowns gradient;          // H' S^-1 innovation
};

Unknowns vector_of(const State<double>& x, const LackingTorques& lacking) {
  Unknowns v;
  x.copy_to(v.data());
  v.tail<2 * kJoints>() << lacking.link[0], lacking.link[1], lacking.motor[0], lacking.motor[1];
  return v;
}

LackingTorques lacking_in(const Unknowns& v) {
  return {{v[kLacking], v[kLacking + 1]}, {v[kLacking + 2], v[kLacking + 3]}};
}

const Eigen::Matrix<double, kReadings, kUnknowns> kReads = [] {
  Eigen::Matrix<double, kReadings, kUnknowns> h = Eigen::Matrix<double, kReadings, kUnknowns>::Zero();
  for (int j = 0; j < kJoints; ++j) {
    h(j, kStateQ + j) = 1;
    h(kJoints + j, kStateTheta + j) = 1;
  }
  return h;
}();

class Filter {
 public:
  Filter(const Parameters& robot, const ExecutedMotion& motion)
      : robot_(robot), motion_(motion), arm_(robot), deviation_(count_deviation(robot)) {
    const State<double> first{motion.q[0], {}, motion.theta[0], {}};
    at_ = vector_of(first, {});
    Unknowns deviation;
    for (Eigen::Index j = 0; j < kJoints; ++j) {
      deviation[kStateQ + j] = 2 * deviation_[j];
      deviation[kStateTheta + j] = 2 * deviation_[kJoints + j];
      deviation[kStateDq + j] = deviation[kStateDtheta + j] = kFirstVelocity;
      deviation[kLacking + j] = deviation[kLacking + kJoints + j] = kFirstLacking * torque_limit(j);
    }
    covariance_ = deviation.cwiseAbs2().asDiagonal();
  }

  std::vector<Step> run() {
    const std::size_t count = motion_.times.size();
    std::vector<Step> steps(count);
    for (std::size_t k = 0; k < count; ++k) {
      read(k, steps[k]);
      if (k + 1 < count) pass(k, steps[k]);
    }
    return steps;
  }

 private:
  double torque_limit(Eigen::Index j) const { return robot_.limits.torque[static_cast<std::size_t>(j)]; }

  // Returns the variances of the readings. Consecutive readings within the same count are worth only one, so the
  // variance is multiplied by their number.
  Reading noise() const {
    Reading variance;
    for (Eigen::Index i = 0; i < kReadings; ++i) {
      const double speed = std::abs(at_[i < kJoints ? kStateDq + i : kStateDtheta + i - kJoints]);
      const double count = std::sqrt(12.0) * deviation_[i];
      const double alike = std::min(kMostAlike, std::max(1.0, count / (speed * kTick + 1e-12)));
      variance[i] = deviation_[i] * deviation_[i] * alike;
    }
    return variance;
  }

  void read(std::size_t k, Step& step) {
    const Reading reading(motion_.q[k][0], motion_.q[k][1], motion_.theta[k][0], motion_.theta[k][1]);
    const Reading innovation = reading - kReads * at_, variance = noise();
    Eigen::Matrix4d expected = kReads * covariance_ * kReads.transpose();
    expected.diagonal() += variance;
    const Eigen::Matrix4d weight = expected.inverse();
    const Eigen::Matrix<double, kUnknowns, kReadings> gain = covariance_ * kReads.transpose() * weight;
    step.kept = UnknownsMatrix::Identity() - gain * kReads;
    step.gradient = kReads.transpose() * weight * innovation;
    at_ += gain * innovation;
    // Joseph form of the update: it stays positive definite in spite of rounding errors.
    covariance_ = step.kept * covariance_ * step.kept.transpose() + gain * variance.asDiagonal() * gain.transpose();
    step.filtered = at_;
    step.covariance = covariance_;
  }

  void pass(std::size_t k, Step& step) {
    const double now = motion_.times[k], next = motion_.times[k + 1];
    const State<double> from = State<double>::from(at_.data());
    const LackingTorques lacking = lacking_in(at_);
    const auto to = arm_.advance(now, next, from, motion_.torque[k], lacking);
    if (!to) {
      throw InputError(
          motion_.log, "tau",
          fmt::format("the arm of the robot file cannot be rolled out under these torques at {:.3f} s", now));
    }
    Joints<double> uncertain;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto row = static_cast<Eigen::Index>(kStateDtheta + j);
      uncertain[j] = std::sqrt(covariance_(row, row));
    }
    const TickSlopes slopes = tick_slopes(robot_, from, *to, motion_.torque[k], lacking, next - now, uncertain);
    step.transition.setIdentity();
    step.transition.topLeftCorner<kStates, kStates>() = slopes.state;
    step.transition.topRightCorner<kStates, 2 * kJoints>() = slopes.lacking;
    at_ = vector_of(*to, lacking);
    covariance_ = step.transition * covariance_ * step.transition.transpose();
    for (Eigen::Index j = 0; j < kJoints; ++j) {
      const double variance = std::pow(kWalk * torque_limit(j), 2) * (next - now);
      covariance_(kLacking + j, kLacking + j) += variance;
      covariance_(kLacking + kJoints + j, kLacking + kJoints + j) += variance;
    }
  }

  const Parameters& robot_;
  const ExecutedMotion& motion_;
  LackingArm arm_;
  Eigen::Vector4d deviation_;  // [rad] of a count
  Unknowns at_;
  UnknownsMatrix covariance_;
};

}  // namespace

LackingTorques SmoothedRun::lacking_at(double time) const {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  return lacking[after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1];
}

SmoothedRun smoothed_run(const Parameters& robot, const ExecutedMotion& motion) {
  const std::vector<Step> steps = Filter(robot, motion).run();
  SmoothedRun run{motion.log, motion.times, std::vector<State<double>>(steps.size()), motion.torque,
                  std::vector<LackingTorques>(steps.size())};
  Unknowns adjoint = Unknowns::Zero();  // of the readings after the tick
  for (std::size_t k = steps.size(); k-- > 0;) {
    const Step& step = steps[k];
    if (k + 1 < steps.size()) adjoint = step.transition.transpose() * adjoint;
    const Unknowns smoothed = step.filtered - step.covariance * adjoint;
    run.states[k] = State<double>::from(smoothed.data());
    run.lacking[k] = lacking_in(smoothed);
    adjoint = step.kept.transpose() * adjoint - step.gradient;
  }
  return run;
}

}  // namespace fjr
