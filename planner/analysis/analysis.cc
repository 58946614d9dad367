#include "planner/analysis/analysis.h"

#include <algorithm>
#include <cmath>

#include "planner/analysis/adjoint.h"
#include "planner/analysis/limit_worth.h"
#include "planner/analysis/optimality.h"
#include "planner/collocation/transcribe.h"

namespace fjr {
namespace {

using Vector8 = Eigen::Matrix<double, kStates, 1>;

// First interval of every leg between via points, and the number of intervals.
std::vector<std::size_t> legs(const Problem& problem, const std::vector<double>& node_times) {
  std::vector<std::size_t> nodes{0};
  for (const Via& via : problem.via) {
    const auto nearest = std::min_element(node_times.begin(), node_times.end(), [&](double a, double b) {
      return std::abs(a - via.time) < std::abs(b - via.time);
    });
    nodes.push_back(static_cast<std::size_t>(nearest - node_times.begin()));
  }
  nodes.push_back(node_times.size() - 1);
  return nodes;
}

bool duration_is_free(const Problem& problem, double duration) {
  return duration - problem.duration.min > kActive * problem.duration.min &&
         problem.duration.max - duration > kActive * problem.duration.max;
}

// d objective / d goal.q. The equilibrium of a goal at rest is theta = q + K^-1 G(q).
Pair<double> goal_worth(const Problem& problem, const Vector8& by_state) {
  Pair<double> worth{by_state(0), by_state(1)};
  if (!problem.goal.at_rest) return worth;
  using D = Dual<kJoints>;
  const Pair<D> q{D::input(problem.goal.q[0], 0), D::input(problem.goal.q[1], 1)};
  const Pair<D> gravity = gravity_torque(problem.robot, q);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const D theta = q[i] + gravity[i] / problem.robot.spring.stiffness[i];
    for (std::size_t j = 0; j < kJoints; ++j) worth[j] += by_state(static_cast<int>(4 + i)) * theta.g[j];
  }
  return worth;
}

// What the trace of effort of a minimum-time problem contributes: its weight depends on the limits (make_arm_ocp()).
template <bool kRate>
void add_trace(const Problem& problem, const Collocated& solution, std::vector<LimitWorth>& worths) {
  const double reg = solution.setup.smoothing.regularisation;
  if (make_arm_ocp<kRate>(problem, reg).regularisation == 0) return;
  double squares = 0;  // int u^2
  const Scheme& scheme = solution.setup.scheme;
  for (std::size_t k = 0; k < solution.motion.intervals.size(); ++k) {
    const auto& interval = solution.motion.intervals[k];
    for (int j = 0; j < scheme.stages(); ++j) {
      const Pair<double> u = solution.motion.torque_in(k, interval.start + scheme.points(j) * interval.duration);
      squares += interval.duration * scheme.b(j) * (u[0] * u[0] + u[1] * u[1]);
    }
  }
  for (LimitWorth& worth : worths) {
    const double step = 1e-4 * worth.limit;
    const auto weight = [&](double change) {
      Problem changed = problem;
      *limit_of(changed.limits, worth.name, worth.joint) += change;
      return make_arm_ocp<kRate>(changed, reg).regularisation;
    };
    worth.worth -= squares * (weight(step) - weight(-step)) / (2 * step);
  }
}

template <bool kRate>
Analysis analyse(const Problem& problem, const Collocated& solution, double scale) {
  const auto t = transcribe<kRate>(problem, solution.setup);
  const Iterate& iterate = solution.report.iterate;
  Adjoint a = adjoint(t, iterate);
  const std::vector<std::size_t> leg = legs(problem, a.node_times);
  const auto by_node = [&](std::size_t node) -> Vector8 {
    return scale * a.lagrangian.segment<kStates>(t.node_at(static_cast<int>(node)));
  };

  Analysis result;
  Optimality& optimality = result.optimality;
  optimality.hamiltonian = hamiltonian(a, leg);
  optimality.stationarity = stationarity(t, iterate, a);
  for (double* h : {&optimality.hamiltonian.mean, &optimality.hamiltonian.spread, &optimality.hamiltonian.largest}) {
    *h *= scale;
  }
  auto& s = optimality.stationarity;
  const double per_control = kRate ? scale / ArmOcp<kRate>::kRateUnit : scale;
  for (double* slope : {&s.free, &s.wrong, &s.largest, &s.residual}) *slope *= per_control;
  const Vector8 start = by_node(0), end = by_node(leg.back());
  optimality.costate_start = State<double>::from(start.data());
  optimality.costate_end = State<double>::from(Vector8(-end).data());

  Sensitivity& sensitivity = result.sensitivity;
  sensitivity.limits = LimitWorths<kRate>(problem, solution.setup, t, iterate).run();
  add_trace<kRate>(problem, solution, sensitivity.limits);
  for (LimitWorth& worth : sensitivity.limits) worth.worth *= scale;
  const auto mean = [&](std::size_t i) { return scale * mean_hamiltonian(a, leg[i], leg[i + 1]); };
  if (duration_is_free(problem, a.node_times.back())) {
    optimality.hamiltonian.expected = -scale * problem.weights.time;
  } else {
    sensitivity.duration = scale * problem.weights.time + mean(leg.size() - 2);
  }
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const Vector8 by_state = by_node(leg[i + 1]);
    ViaWorth via{problem.via[i].time, {by_state(0), by_state(1)}, {}, mean(i) - mean(i + 1)};
    if (problem.via[i].dq) via.dq = Pair<double>{by_state(2), by_state(3)};
    sensitivity.via.push_back(via);
  }
  sensitivity.goal = goal_worth(problem, end);
  return result;
}

}  // namespace

Analysis analyse(const Problem& problem, const Collocated& solution, double scale) {
  return needs_rate(problem) ? analyse<true>(problem, solution, scale) : analyse<false>(problem, solution, scale);
}

}  // namespace fjr
