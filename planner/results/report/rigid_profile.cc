#include "planner/results/report/rigid_profile.h"

#include <algorithm>
#include <cmath>

namespace fjr {
namespace {

constexpr double kPeriod = 1e-3;       // [s] at most between rows
constexpr double kPeakVelocity = 1.5;  // ds/dc of the trapezoid: 1 / (1/3 / 2 + 1/3 + 1/3 / 2)
constexpr double kAcceleration = 4.5;  // d2s/dc2 of the trapezoid: kPeakVelocity / (1/3)
constexpr double kAfterJump = 1e-9;    // fraction of the time: safely on the later side

Along trapezoid(double c) {
  if (c < 1.0 / 3) return {kAcceleration * c * c / 2, kAcceleration * c, kAcceleration};
  if (c < 2.0 / 3) return {kPeakVelocity * (c - 1.0 / 6), kPeakVelocity, 0};
  const double left = 1 - c;
  return {1 - kAcceleration * left * left / 2, kAcceleration * left, -kAcceleration};
}

Along minimum_jerk(double c) {
  return {c * c * c * (10 + c * (-15 + 6 * c)), 30 * c * c * (1 + c * (-2 + c)), 60 * c * (1 + c * (-3 + 2 * c))};
}

// Computes reference and torque at `along` on the straight line in joint space between two rest states.
class StraightWay {
 public:
  StraightWay(const Parameters& p, const Joints<double>& from, const Joints<double>& to, double duration)
      : p_(p), from_(rest_at(p, from)), to_(rest_at(p, to)), duration_(duration) {}

  Sample at(double time, const Along& a) const {
    Sample row;
    row.time = time;
    Joints<double> ddq, ddtheta;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double links = to_.q[j] - from_.q[j], motors = to_.theta[j] - from_.theta[j];
      row.state.q[j] = from_.q[j] + links * a.position;
      row.state.theta[j] = from_.theta[j] + motors * a.position;
      row.state.dq[j] = links * a.velocity / duration_;
      row.state.dtheta[j] = motors * a.velocity / duration_;
      ddq[j] = links * a.acceleration / (duration_ * duration_);
      ddtheta[j] = motors * a.acceleration / (duration_ * duration_);
    }
    row.torque = rigid_inverse_dynamics(row.state, ddq, ddtheta);
    return row;
  }

 private:
  Joints<double> rigid_inverse_dynamics(const State<double>& x, const Joints<double>& ddq,
                                        const Joints<double>& ddtheta) const {
    const MassMatrix<double> m = mass_matrix(p_, x.q[1]);
    const Joints<double> c = coriolis_torque(p_, x.q, x.dq), g = gravity_torque(p_, x.q);
    Joints<double> torque{m.m11 * ddq[0] + m.m12 * ddq[1], m.m12 * ddq[0] + m.m22 * ddq[1]};
    for (std::size_t j = 0; j < kJoints; ++j) {
      torque[j] += c[j] + g[j] + p_.link.damping[j] * x.dq[j] + p_.motor.inertia[j] * ddtheta[j] +
                   FrictionLaw::of(p_, static_cast<int>(j)).torque(x.dtheta[j]);
    }
    return torque;
  }

  const Parameters& p_;
  State<double> from_, to_;
  double duration_;
};

}  // namespace

const char* name(Profile profile) { return profile == Profile::kMinimumJerk ? "minimum jerk" : "trapezoidal velocity"; }

Along along(Profile profile, double c) {
  const double fraction = std::clamp(c, 0.0, 1.0);
  return profile == Profile::kMinimumJerk ? minimum_jerk(fraction) : trapezoid(fraction);
}

Trajectory rigid_reference(const Parameters& p, Profile profile, const Joints<double>& from, const Joints<double>& to,
                           double duration) {
  const int third = static_cast<int>(std::ceil(duration / (3 * kPeriod))), rows = 3 * third;
  const StraightWay way(p, from, to, duration);
  Trajectory reference;
  for (int k = 0; k <= rows; ++k) {
    const double c = static_cast<double>(k) / rows, time = duration * c;
    const bool jump = profile == Profile::kTrapezoidal && (k == third || k == 2 * third);
    if (jump) reference.samples.push_back(way.at(time - kJumpSpacing, along(profile, c - kJumpSpacing / duration)));
    reference.samples.push_back(way.at(time, along(profile, jump ? c + kAfterJump : c)));
  }
  return reference;
}

ElasticRun run_on_elastic_arm(const Parameters& p, const Trajectory& reference) {
  ElasticRun run{simulate(p, p, reference, ControlMode::kClosedLoop, kWatchedAfterEnd), {}};
  run.figures = figures_of(p, reference, run.simulation, kSettled);
  return run;
}

}  // namespace fjr
