#include "planner/collocation/margins.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/friction.h"
#include "model/kinematics.h"

namespace fjr {
namespace {

constexpr int kProbes = 16;       // pieces an interval is looked at in; polynomials of degree <= 4 bend little between
constexpr double kKeep = 0.8;     // share of the back-off that is left to the sampling and the rollout
constexpr double kEnlarge = 1.2;  // margins answer an excess with a little more
constexpr double kLeast = 1e-5;   // share of a limit: the optimiser does not see less
constexpr double kNegligible = 1e-7;  // share of a limit: an excess below a tenth of what the certificate allows
constexpr double kWindow = 0.03;      // share of the duration around a given state that lies on a limit

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

// A state that the request gives, at a share of the duration, and what it asks of each limit.
struct Given {
  double share;
  Limits needs;
};

Limits needs_of(const Problem& problem, const State<double>& x) {
  Limits needs = zero();
  for (std::size_t j = 0; j < kJoints; ++j) {
    raise(needs.motor_velocity[j], x.dtheta[j]);
    raise(needs.link_position[j], x.q[j]);
    raise(needs.spring_deflection[j], x.theta[j] - x.q[j]);
  }
  raise(needs.tip_speed, std::sqrt(tip_speed_squared(problem.robot, x.q[1], x.dq)));
  return needs;
}

std::vector<Given> given_states(const Problem& problem) {
  std::vector<Given> given{{0, needs_of(problem, problem.start)}};
  for (const Via& via : problem.via) {  // what is free there asks nothing
    const Pair<double> dq = via.dq.value_or(Pair<double>{0, 0});
    given.push_back({via.time / problem.duration.max, needs_of(problem, {via.q, dq, via.q, {0, 0}})});
  }
  const Goal& goal = problem.goal;
  const Pair<double> still{0, 0};
  given.push_back({1, needs_of(problem, {goal.q, goal.dq, goal.theta.value_or(goal.q), goal.dtheta.value_or(still)})});
  return given;
}

bool lies_on_limit(const Given& given, const Limits& limits, std::size_t i) {
  return given.needs.data()[i] > limits.data()[i] * (1 - kBackOff);
}

// Margins cannot act on an interval, from and to in shares of the duration, where a given state lies on limit i: on its
// positions for as long as leaving takes (the motors move the links through the springs: as the fourth power of time),
// on rows that are asked at the state itself only there. Velocities are left at once.
bool held(const Problem& problem, const std::vector<Given>& given, std::size_t i, double from, double to) {
  const auto first = [&](const double* member) { return static_cast<std::size_t>(member - problem.limits.data()); };
  const bool velocity =
      i >= first(problem.limits.motor_velocity.data()) && i < first(problem.limits.link_position.data());
  const bool position =
      i >= first(problem.limits.link_position.data()) && i < first(problem.limits.spring_deflection.data());
  if (velocity) return false;
  const double window = position ? kWindow : 1e-9;
  return std::any_of(given.begin(), given.end(), [&](const Given& g) {
    return lies_on_limit(g, problem.limits, i) && from < g.share + window && to > g.share - window;
  });
}

// The limits less the back-off that there is room for.
Limits backed_off(const Problem& problem, const std::vector<Given>& given) {
  Limits kept = problem.limits;
  for (std::size_t i = 0; i < Limits::kCount; ++i) {
    kept.data()[i] *= 1 - kBackOff;
    for (const Given& state : given) {
      if (lies_on_limit(state, problem.limits, i)) kept.data()[i] = problem.limits.data()[i];
    }
  }
  return kept;
}

}  // namespace

std::vector<Limits> kept_limits(const Problem& problem, const Mesh& mesh, const std::vector<Limits>& margins) {
  const std::vector<Given> given = given_states(problem);
  std::vector<Limits> kept(mesh.size(), backed_off(problem, given));
  if (margins.empty()) return kept;
  const std::vector<double> nodes =
      mesh.node_times(std::vector<double>(static_cast<std::size_t>(mesh.segments()), 1.0));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const double from = nodes[k] / nodes.back(), to = nodes[k + 1] / nodes.back();
    for (std::size_t i = 0; i < Limits::kCount; ++i) {
      if (!held(problem, given, i, from, to)) kept[k].data()[i] -= margins[k].data()[i];
    }
  }
  return kept;
}

std::vector<Limits> excesses(const Problem& problem, const Motion& motion) {
  const Pair<FrictionLaw> friction{FrictionLaw::of(problem.robot, 0), FrictionLaw::of(problem.robot, 1)};
  const std::vector<Given> given = given_states(problem);
  const Limits kept = backed_off(problem, given);
  std::vector<Limits> result;
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    const double from = motion.intervals[k].start / motion.duration();
    const double to = from + motion.intervals[k].duration / motion.duration();
    Limits excess = reached_in(problem, friction, motion, k);
    for (std::size_t i = 0; i < Limits::kCount; ++i) {
      const double limit = problem.limits.data()[i];
      const double over = excess.data()[i] - (limit - kKeep * (limit - kept.data()[i]));
      const bool counts = std::isfinite(limit) && over > kNegligible * limit && !held(problem, given, i, from, to);
      excess.data()[i] = counts ? over : 0.0;
    }
    result.push_back(excess);
  }
  return result;
}

double largest_share_kept_free(const Limits& limits, const std::vector<Limits>& margins) {
  double share = kBackOff;
  for (const Limits& margin : margins) {
    for (std::size_t i = 0; i < Limits::kCount; ++i) {
      if (std::isfinite(limits.data()[i])) share = std::max(share, kBackOff + margin.data()[i] / limits.data()[i]);
    }
  }
  return share;
}

std::string worst_excess(const Problem& problem, const Motion& motion) {
  const std::vector<Limits> excess = excesses(problem, motion);
  double worst = 0;
  std::string sentence;
  const auto consider = [&](std::string_view name, std::string_view unit, std::size_t joint, double over, double limit,
                            double time) {
    if (!(over > worst * limit)) return;
    worst = over / limit;
    const std::string of_joint = joint == 0 ? "" : fmt::format(" of joint {}", joint);
    sentence =
        fmt::format("{}{} exceeds its limit {:.6g} {} by {:.3g} at {:.3f} s", name, of_joint, limit, unit, over, time);
  };
  for (std::size_t k = 0; k < excess.size(); ++k) {
    const double time = motion.intervals[k].start;
    visit_pair_limits(problem.limits, [&](std::string_view name, std::string_view unit, const Pair<double>& limit) {
      const auto at = static_cast<std::size_t>(limit.data() - problem.limits.data());
      for (std::size_t j = 0; j < kJoints; ++j) consider(name, unit, j + 1, excess[k].data()[at + j], limit[j], time);
    });
    consider("tip_speed", "m/s", 0, excess[k].tip_speed, problem.limits.tip_speed, time);
  }
  return sentence;
}

bool widen(std::vector<Limits>& margins, const std::vector<Limits>& excesses, const Limits& limits) {
  if (margins.empty()) margins.assign(excesses.size(), zero());
  bool any = false;
  for (std::size_t k = 0; k < margins.size(); ++k) {
    for (std::size_t i = 0; i < Limits::kCount; ++i) {
      if (!(excesses[k].data()[i] > 0)) continue;
      double& margin = margins[k].data()[i];
      margin += std::max(margin, kEnlarge * excesses[k].data()[i] + kLeast * limits.data()[i]);
      any = true;
    }
  }
  return any;
}

}  // namespace fjr
