// The analysis as a template on the features of the problem; analyse() chooses the instance.
#pragma once

#include <vector>

#include "common/dual.h"
#include "planner/analysis/analysis.h"
#include "planner/analysis/optimality.h"
#include "planner/analysis/shadow_prices.h"
#include "planner/collocation/adjoint.h"
#include "planner/ocp/arm_collocation.h"

namespace fjr {

namespace arm_analysis {

using Vector8 = Eigen::Matrix<double, kStates, 1>;

// Returns the index of the first interval of every segment between via points, and then the number of intervals.
inline std::vector<std::size_t> segment_begins(const Problem& problem, const Mesh& mesh) {
  std::vector<std::size_t> nodes{0};
  for (std::size_t s = 0; s < segment_count(problem); ++s) nodes.push_back(end_node(mesh, s));
  return nodes;
}

inline bool duration_is_free(const Problem& problem, double duration) {
  return duration - problem.duration.min > kActive * problem.duration.min &&
         problem.duration.max - duration > kActive * problem.duration.max;
}

// Returns d objective / d goal.q [1/rad], 0 for a free joint. At a goal at rest, theta = q + K^-1 G(q) changes with q.
inline Joints<double> price_of_goal(const Problem& problem, const State<double>& by_state) {
  Joints<double> price = by_state.q;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (problem.goal.free[j]) price[j] = 0;
  }
  if (!problem.goal.at_rest || problem.goal.any_free()) return price;  // if free, theta is not given but follows
  using D = Dual<kJoints>;
  const Joints<D> q{D::input(problem.goal.q[0], 0), D::input(problem.goal.q[1], 1)};
  const Joints<D> gravity = gravity_torque(problem.robot, q);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const D theta = q[i] + gravity[i] / problem.robot.spring.stiffness[i];
    for (std::size_t j = 0; j < kJoints; ++j) price[j] += by_state.theta[i] * theta.g[j];
  }
  return price;
}

// Adds the contribution of the regularising effort of a minimum-time problem to the prices of active limits, because
// the weight of the regularisation depends on the torque limits (make_arm_ocp()).
template <Features F>
void add_regularisation(const Problem& problem, const Collocated& solution, std::vector<ShadowPrice>& prices) {
  const double reg = solution.setup.smoothing.regularisation;
  if (make_arm_ocp<F>(problem, reg).regularisation == 0) return;
  double squares = 0;  // int u^2
  const Scheme& scheme = solution.setup.scheme;
  for (std::size_t k = 0; k < solution.motion.intervals.size(); ++k) {
    const auto& interval = solution.motion.intervals[k];
    for (int j = 0; j < scheme.stages(); ++j) {
      const Joints<double> u = solution.motion.torque_in(k, interval.start + scheme.points(j) * interval.duration);
      squares += interval.duration * scheme.b(j) * (u[0] * u[0] + u[1] * u[1]);
    }
  }
  for (ShadowPrice& price : prices) {
    if (price.index >= kLimits || price.active.empty()) continue;
    Problem changed = problem;
    double& limit = kLimitNames[price.index].in(changed.limits);
    const double step = 1e-4 * price.limit;
    const auto weight = [&](double change) {
      limit = price.limit + change;
      return make_arm_ocp<F>(changed, reg).regularisation;
    };
    price.price -= squares * (weight(step) - weight(-step)) / (2 * step);
  }
}

}  // namespace arm_analysis

template <Features F>
Analysis analyse_with(const Problem& problem, const Collocated& solution, double scale) {
  namespace parts = arm_analysis;
  const auto t = arm_collocation::transcribe<F>(problem, solution.setup);
  const Iterate& iterate = solution.report.iterate;
  const Adjoint a = adjoint(t, iterate);
  const std::vector<std::size_t> begins = parts::segment_begins(problem, t.mesh());
  const auto by_node = [&](std::size_t node) {
    const parts::Vector8 slope = scale * a.lagrangian.segment<kStates>(t.node_at(static_cast<int>(node)));
    return State<double>::from(slope.data());
  };

  Analysis result;
  Optimality& optimality = result.optimality;
  optimality.hamiltonian = hamiltonian(a, begins);
  optimality.friction_width = solution.setup.smoothing.friction_width;
  optimality.hamiltonian.allowed = scale * allowed_spread(solution.report.objective, a.node_times.back());
  optimality.stationarity = stationarity(t, iterate, a);
  for (double* h : {&optimality.hamiltonian.mean, &optimality.hamiltonian.spread, &optimality.hamiltonian.largest}) {
    *h *= scale;
  }
  auto& s = optimality.stationarity;
  const double per_control = F.rate ? scale / ArmOcp<F>::kRateUnit : scale;
  for (double* slope : {&s.free, &s.wrong, &s.largest, &s.residual}) *slope *= per_control;
  const State<double> end = by_node(begins.back());
  optimality.costate_start = by_node(0);
  for (std::size_t i = 0; i < kStates; ++i) optimality.costate_end[i] = -end[i];
  const std::vector<double> along = conserved_along(a, begins);
  for (std::size_t k = 0; k < along.size(); ++k) {
    const Eigen::VectorXd p =
        scale * costates(t, iterate.lambda, static_cast<int>(k)).transpose() * solution.setup.scheme.b;
    optimality.along.push_back(
        {(a.node_times[k] + a.node_times[k + 1]) / 2, scale * along[k], State<double>::from(p.data())});
  }

  Sensitivity& sensitivity = result.sensitivity;
  sensitivity.limits = ShadowPrices<F>(problem, solution.setup, t, iterate).run();
  parts::add_regularisation<F>(problem, solution, sensitivity.limits);
  for (ShadowPrice& price : sensitivity.limits) price.price *= scale;
  const auto mean = [&](std::size_t i) { return scale * mean_hamiltonian(a, begins[i], begins[i + 1]); };
  if (parts::duration_is_free(problem, a.node_times.back())) {
    optimality.hamiltonian.expected = -scale * problem.weights.time;
  } else {
    sensitivity.duration = scale * problem.weights.time + mean(begins.size() - 2);
  }
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const State<double> by_state = by_node(begins[i + 1]);
    ViaPrices via{a.node_times[begins[i + 1]], by_state.q, {}, {}};
    if (problem.via[i].time) via.later = mean(i) - mean(i + 1);
    if (problem.via[i].dq) via.dq = by_state.dq;
    sensitivity.via.push_back(via);
  }
  sensitivity.goal = parts::price_of_goal(problem, end);
  return result;
}

}  // namespace fjr
