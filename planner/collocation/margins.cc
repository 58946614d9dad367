#include "planner/collocation/margins.h"

#include <algorithm>
#include <cmath>

#include "model/friction.h"
#include "model/kinematics.h"
#include "planner/collocation/collocate.h"

namespace fjr {
namespace {

constexpr int kProbes = 16;       // pieces an interval is looked at in; polynomials of degree <= 4 bend little between
constexpr double kKeep = 0.8;     // share of the back-off that is left to the sampling and the rollout
constexpr double kEnlarge = 1.2;  // margins answer an excess with a little more

Limits zero() {
  Limits l;
  std::fill_n(l.data(), Limits::kCount, 0.0);
  return l;
}

void raise(double& largest, double value) { largest = std::max(largest, std::abs(value)); }

// Largest magnitude of everything that is limited, on one interval.
Limits reached_in(const Problem& problem, const Pair<FrictionLaw>& friction, const Motion& motion, std::size_t k) {
  Limits reached = zero();
  const auto& interval = motion.intervals[k];
  State<double> before{};
  Pair<double> u_before{};
  for (int i = 0; i <= kProbes; ++i) {
    const double time = interval.start + interval.duration * i / kProbes;
    const State<double> x = motion.state_in(k, time);
    const Pair<double> u = motion.torque_in(k, time);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double now = friction[j].nonlinear(x.dtheta[j]);
      raise(reached.torque[j], u[j] + now);
      if (i > 0) {  // a step of the law may lie anywhere between the probes
        const double last = friction[j].nonlinear(before.dtheta[j]);
        raise(reached.torque[j], u[j] + last);
        raise(reached.torque[j], u_before[j] + now);
        raise(reached.torque_rate[j], (u[j] - u_before[j]) * kProbes / interval.duration);
      }
      raise(reached.motor_velocity[j], x.dtheta[j]);
      raise(reached.link_position[j], x.q[j]);
      raise(reached.spring_deflection[j], x.theta[j] - x.q[j]);
    }
    raise(reached.tip_speed, std::sqrt(tip_speed_squared(problem.robot, x.q[1], x.dq)));
    before = x;
    u_before = u;
  }
  return reached;
}

}  // namespace

std::vector<Limits> excesses(const Problem& problem, const Motion& motion) {
  const Pair<FrictionLaw> friction{FrictionLaw::of(problem.robot, 0), FrictionLaw::of(problem.robot, 1)};
  std::vector<Limits> result;
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    Limits excess = reached_in(problem, friction, motion, k);
    for (std::size_t i = 0; i < Limits::kCount; ++i) {
      const double limit = problem.limits.data()[i] * (1 - kKeep * kBackOff);
      excess.data()[i] = std::isfinite(limit) ? std::max(0.0, excess.data()[i] - limit) : 0.0;
    }
    result.push_back(excess);
  }
  return result;
}

bool widen(std::vector<Limits>& margins, const std::vector<Limits>& excesses) {
  if (margins.empty()) margins.assign(excesses.size(), zero());
  bool any = false;
  for (std::size_t k = 0; k < margins.size(); ++k) {
    for (std::size_t i = 0; i < Limits::kCount; ++i) {
      margins[k].data()[i] += kEnlarge * excesses[k].data()[i];
      any = any || excesses[k].data()[i] > 0;
    }
  }
  return any;
}

}  // namespace fjr
