// The optimisation of one arm problem, templated on the features it supports. collocate() chooses the instance. Each
// instance is compiled in a file of its own, because the templates take long to compile.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "planner/collocation/adjoint.h"
#include "planner/collocation/transcription.h"
#include "planner/collocation/transfer.h"
#include "planner/ocp/arm_ocp.h"
#include "planner/ocp/collocate.h"
#include "planner/ocp/margins.h"
#include "planner/ocp/sampling.h"
#include "planner/ocp/segments.h"
#include "planner/problem/motion_price.h"
#include "planner/problem/task/task.h"
#include "planner/trajectory/motion.h"

namespace fjr {

inline constexpr Features kPlain{};
inline constexpr Features kWithTask{.task_rows = 24};
inline constexpr Features kRateWithTask{.rate = true, .task_rows = 24};
inline constexpr Features kWithPeak{.task_rows = 24, .peak = true};
inline constexpr Features kEverything{.rate = true, .task_rows = static_cast<int>(kMostTaskRows), .peak = true};
inline constexpr Features kSlackTask{.task_rows = 24, .slack = true};
inline constexpr Features kSlackEverything{.rate = true, .task_rows = static_cast<int>(kMostTaskRows), .slack = true};

// Returns the number of the task's rows. Throws std::logic_error if the largest set of features has no room for them.
inline std::size_t rows_with_room(const Task& task) {
  const std::size_t rows = count_of_rows(task);
  if (rows > kMostTaskRows) throw std::logic_error("kMostTaskRows is too small");
  return rows;
}

// Calls visit<F>() with the smallest set of features that supports the problem.
template <class Visit>
auto with_features(const Problem& problem, Visit&& visit) {
  const Limits& limits = problem.limits;
  // du/dt is the control only if it is limited or penalised, because the two additional states cost time.
  const bool rate =
      problem.weights.torque_rate > 0 || limits.torque_rate[0] < kNoLimit || limits.torque_rate[1] < kNoLimit;
  const std::size_t rows = rows_with_room(problem.task);
  const bool task = rows > 0 || problem.goal.any_free(), peak = problem.weights.peak_torque > 0;
  const bool few = rows <= static_cast<std::size_t>(kWithTask.task_rows);
  if (!task && !peak && !rate) return visit.template operator()<kPlain>();
  if (few && !peak && !rate) return visit.template operator()<kWithTask>();
  if (few && !peak) return visit.template operator()<kRateWithTask>();
  if (few && !rate) return visit.template operator()<kWithPeak>();
  return visit.template operator()<kEverything>();
}

// Calls visit<F>() likewise for problems with a slack.
template <class Visit>
auto with_slack_features(const Problem& problem, Visit&& visit) {
  const Joints<double>& rate = problem.limits.torque_rate;
  const bool few = rows_with_room(problem.task) <= static_cast<std::size_t>(kSlackTask.task_rows);
  if (few && rate[0] == kNoLimit && rate[1] == kNoLimit) return visit.template operator()<kSlackTask>();
  return visit.template operator()<kSlackEverything>();
}

// Solves the problem from a guess or from an earlier solution; exactly one of `guess` and `start` is not null.
template <Features F>
Collocated collocate_with(const Problem& problem, const CollocationSetup& setup, const Guess* guess,
                          const Collocated* start, const SolveOptions& options);

// ---- the template's parts ----

namespace arm_collocation {

template <int N>
NodeBounds<N> node(std::size_t index) {
  return {index, filled<N>(-kNoLimit), filled<N>(kNoLimit)};
}

template <int N>
void fix(NodeBounds<N>& bounds, std::size_t first, const Joints<double>& values) {
  for (std::size_t j = 0; j < kJoints; ++j) bounds.lower[first + j] = bounds.upper[first + j] = values[j];
}

// Returns whether the slack lowers the velocity at via point `at`, or at the goal if `at` is the number of via points.
inline bool relaxes_velocity(const Problem& problem, std::size_t at) {
  return problem.variation.slack && problem.variation.slack->velocity == at;
}

// Returns start, via points and goal as bounds on the state at nodes of the mesh.
template <int N>
std::vector<NodeBounds<N>> node_bounds(const Problem& problem, const Mesh& mesh) {
  std::vector<NodeBounds<N>> bounds;
  auto start = node<N>(0);
  for (std::size_t i = 0; i < kStates; ++i) start.lower[i] = start.upper[i] = problem.start[i];
  bounds.push_back(start);
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const Via& via = problem.via[i];
    auto at = node<N>(end_node(mesh, i));
    for (std::size_t j = 0; j < kJoints; ++j) {
      at.lower[j] = via.q[j] - via.tolerance;
      at.upper[j] = via.q[j] + via.tolerance;
    }
    if (via.dq && !relaxes_velocity(problem, i)) fix(at, kStateDq, *via.dq);
    bounds.push_back(at);
  }
  auto goal = node<N>(mesh.size());
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!problem.goal.free[j]) goal.lower[j] = goal.upper[j] = problem.goal.q[j];
  }
  if (!problem.goal.dq_free && !relaxes_velocity(problem, problem.via.size())) fix(goal, kStateDq, problem.goal.dq);
  if (problem.goal.theta) fix(goal, kStateTheta, *problem.goal.theta);
  if (problem.goal.dtheta) fix(goal, kStateDtheta, *problem.goal.dtheta);
  bounds.push_back(goal);
  return bounds;
}

// Returns path constraints at the goal for motions that may end anywhere and end at rest: the springs carry gravity,
// and the motors can hold it.
template <Features F>
std::vector<RowBounds> goal_rows(const Problem& problem, const Mesh& mesh) {
  std::vector<RowBounds> rows;
  if (!problem.goal.any_free() || !problem.goal.at_rest) return rows;
  for (int j = 0; j < kJoints; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double held = problem.limits.torque[i] / problem.robot.spring.stiffness[i];
    rows.push_back({mesh.size(), ArmOcp<F>::kEquilibrium + j, 0, 0});
    rows.push_back({mesh.size(), row_of(SpringDeflection::info) + j, -held, held});
  }
  return rows;
}

// Adds the constraints of the velocity that the slack lowers.
template <Features F>
void add_velocity_rows(const Problem& problem, const Mesh& mesh, ArmOcp<F>& ocp) {
  const auto at = problem.variation.slack->velocity;
  if (!at) return;
  const auto j_of = [](int j) { return static_cast<std::size_t>(j); };
  const std::size_t node = *at < problem.via.size() ? end_node(mesh, *at) : mesh.size();
  for (int j = 0; j < kJoints; ++j) {
    ocp.rows_at_nodes.push_back(
        {node, ArmOcp<F>::kRelaxedVelocity + j, ocp.velocity_relaxation[j_of(j)], ocp.velocity_relaxation[j_of(j)]});
  }
}

// Fraction of an interval: torques are read this far inside of it, because they may jump at its ends.
inline constexpr double kInside = 1e-6;

inline Joints<double> torque_margins(const CollocationSetup& setup, std::size_t k) {
  constexpr std::size_t kFirst = Quantities::first_limit<Torque>();
  return setup.margins.empty() ? Joints<double>{0, 0}
                               : Joints<double>{setup.margins[k][kFirst], setup.margins[k][kFirst + 1]};
}

// Bounds of a pause: |dq| and |dtheta| by `speed` [rad/s], and |u| by the friction torque at that speed.
template <Features F>
void keep_still(typename ArmOcp<F>::Bounds& b, const Parameters& robot, double speed) {
  const auto within = [](double& lower, double& upper, double bound) {
    lower = std::max(lower, -bound);
    upper = std::min(upper, bound);
  };
  for (std::size_t j = 0; j < kJoints; ++j) {
    for (const std::size_t velocity : {kStateDq + j, kStateDtheta + j}) {
      within(b.x_lower[velocity], b.x_upper[velocity], speed);
    }
    const double held = std::abs(FrictionLaw::of(robot, static_cast<int>(j)).nonlinear(speed));
    if constexpr (F.rate) {
      within(b.x_lower[ArmOcp<F>::kArm + j], b.x_upper[ArmOcp<F>::kArm + j], held);
    } else {
      within(b.u_lower[j], b.u_upper[j], held);
    }
  }
}

template <Features F>
std::vector<typename ArmOcp<F>::Bounds> interval_bounds(const Problem& problem, const CollocationSetup& setup) {
  std::vector<typename ArmOcp<F>::Bounds> bounds;
  const std::vector<TightenedLimits> tightened = tightened_limits(problem, setup.mesh, setup.margins);
  const std::optional<Pause>& pause = problem.variation.pause;
  const std::vector<double> times = pause ? setup.mesh.node_times({problem.duration.max}) : std::vector<double>{};
  for (std::size_t k = 0; k < setup.mesh.size(); ++k) {
    auto here = path_bounds<F>(tightened[k].limits);
    if constexpr (F.peak) bound_peaks<F>(here, problem, torque_margins(setup, k));
    for (std::size_t r = 0; r < tightened[k].task_rows.size(); ++r) {
      here.row_lower[ArmOcp<F>::kTask + r] = tightened[k].task_rows[r][0];
      here.row_upper[ArmOcp<F>::kTask + r] = tightened[k].task_rows[r][1];
    }
    if constexpr (F.slack) bound_with_slack<F>(here, problem.limits, *problem.variation.slack);
    for (std::size_t j = 0; j < kJoints && !setup.creep.empty(); ++j) {
      const double creep = setup.creep[k][j];
      if (creep > 0) here.x_lower[kStateDtheta + j] = creep;
      if (creep < 0) here.x_upper[kStateDtheta + j] = creep;
    }
    if (pause && pause->contains(std::midpoint(times[k], times[k + 1])))
      keep_still<F>(here, problem.robot, pause->speed);
    bounds.push_back(here);
  }
  return bounds;
}

// Bounds u at the start where u is a state. Path constraints are not imposed at the start, because the state of the arm
// is given there; but u is free and so needs bounds from the limits on torque and power. Limits that a slack relaxes
// are left out here.
template <Features F>
void bound_first_torque(const Problem& problem, ArmOcp<F>& ocp) {
  const auto limit_that_stays = [&](const QuantityInfo& info, std::size_t j) {
    return problem.variation.slack && problem.variation.slack->direction[first_limit_of(info) + j] > 0
               ? kNoLimit
               : info.in(problem.limits, j);
  };
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double by_power = limit_that_stays(MotorPower::info, j) / std::abs(problem.start.dtheta[j]);
    const double limit = std::min(limit_that_stays(Torque::info, j), by_power) * (1 - kBaseMargin);
    if (limit == kNoLimit) continue;
    const double friction = ocp.friction[j].nonlinear(problem.start.dtheta[j]);
    ocp.at_nodes.front().lower[ArmOcp<F>::kArm + j] = -limit - friction;
    ocp.at_nodes.front().upper[ArmOcp<F>::kArm + j] = limit - friction;
  }
}

// Returns the costs at the collocation points that represent the price, interval after interval. A change of the motion
// on an interval is the sum of its changes at the collocation points times their Lagrange polynomials. Therefore each
// piece of the price is integrated with these polynomials, so that even a short piece between two points counts.
template <Features F>
auto point_costs(const MotionPrice& price, const Scheme& scheme, const Mesh& mesh) {
  using Ocp = ArmOcp<F>;
  constexpr int kOfTorque = F.rate ? Ocp::kArm : Ocp::kStates;
  std::vector<PointCost<Ocp::kStates + Ocp::kControls>> costs;
  const std::vector<double> times = mesh.node_times(price.durations);
  auto first = price.pieces.begin();
  for (std::size_t k = 0; k < mesh.size(); ++k) {
    const double begin = times[k], length = times[k + 1] - begin;
    while (first + 1 < price.pieces.end() && first->end <= begin) ++first;
    for (int j = 0; j < scheme.stages(); ++j) {
      const auto integral = [&](double c) {  // of l_j from 0 to c
        double sum = 0, power = c;
        for (int d = 0; d < scheme.stages(); ++d, power *= c) sum += scheme.lagrange(j, d) / (d + 1) * power;
        return sum;
      };
      auto& cost = costs.emplace_back();
      for (auto piece = first; piece < price.pieces.end() && piece->begin < times[k + 1]; ++piece) {
        const double from = std::max(0.0, (piece->begin - begin) / length),
                     to = std::min(1.0, (piece->end - begin) / length);
        const double part = (integral(to) - integral(from)) / scheme.b(j);
        cost.value += part * piece->density;
        for (std::size_t i = 0; i < kStates; ++i) cost.slope[i] += part * piece->by_state[i];
        for (std::size_t i = 0; i < kJoints; ++i) cost.slope[kOfTorque + i] += part * piece->by_torque[i];
      }
      const double time = begin + length * std::clamp(scheme.points(j), kInside, 1 - kInside);
      const std::size_t interval = price.near.interval_at(time);
      price.near.state_in(interval, time).copy_to(cost.near.data());
      const Joints<double> torque = price.near.torque_in(interval, time);
      std::copy(torque.begin(), torque.end(), cost.near.begin() + kOfTorque);
      std::copy(price.curvature.begin(), price.curvature.end(), cost.curvature.begin());
    }
  }
  return costs;
}

// max(0, tau dtheta) has a corner at dtheta = 0. It is smoothed with the width of the friction law. [W], and [W s/rad]
inline constexpr double kLeastKink = 0.01, kKinkPerWidth = 10;

template <Features F>
Transcription<ArmOcp<F>> transcribe(const Problem& problem, const CollocationSetup& setup) {
  auto ocp = make_arm_ocp<F>(problem, setup.smoothing.regularisation);
  ocp.bounds = interval_bounds<F>(problem, setup);
  for (FrictionLaw& law : ocp.friction) law = law.smoothed(setup.smoothing.friction_width);
  ocp.kink = std::hypot(kLeastKink, kKinkPerWidth * setup.smoothing.friction_width);
  ocp.cost_nodes = {{release_node(problem, setup.mesh), Node::kRelease}, {setup.mesh.size(), Node::kGoal}};
  for (std::size_t s = 0; s < segment_count(problem); ++s) {
    ocp.tasks.push_back(task_rows(problem.robot, problem.task, s));
  }
  ocp.at_nodes = node_bounds<ArmOcp<F>::kStates>(problem, setup.mesh);
  if constexpr (F.rate) bound_first_torque(problem, ocp);
  if constexpr (F.task_rows > 0) ocp.rows_at_nodes = goal_rows<F>(problem, setup.mesh);
  if constexpr (F.slack) add_velocity_rows<F>(problem, setup.mesh, ocp);
  if (problem.variation.price) ocp.point_costs = point_costs<F>(*problem.variation.price, setup.scheme, setup.mesh);
  ocp.durations = segment_durations(problem);
  ocp.duration_sums = duration_sums(problem);
  Transcription<ArmOcp<F>> transcription{std::move(ocp), setup.scheme, setup.mesh};
  if (only_time(problem.weights) && !problem.variation.price) transcription.let_states_follow();
  return transcription;
}

// Positions of the trapezoidal rule stay as they were solved: here its integrals would not meet the next node.
template <Features F>
Motion motion_of(const Transcription<ArmOcp<F>>& transcription, const Eigen::VectorXd& z) {
  Motion motion;
  const std::vector<double> times = transcription.mesh().node_times(transcription.durations(z));
  for (int k = 0; k < transcription.intervals(); ++k) {
    const double start = times[static_cast<std::size_t>(k)], end = times[static_cast<std::size_t>(k) + 1];
    const Eigen::MatrixXd solved = transcription.state_polynomial(z, k),
                          state = integrates_velocities(solved) ? integrate_positions(solved, end - start) : solved;
    if constexpr (F.rate) {
      motion.intervals.push_back({start, end - start, state.topRows<kStates>(), state.middleRows<kControls>(kStates)});
    } else {
      motion.intervals.push_back(
          {start, end - start, state.topRows<kStates>(), transcription.control_polynomial(z, k)});
    }
  }
  return motion;
}

template <Features F>
Iterate evaluate_guess(const Transcription<ArmOcp<F>>& transcription, const Guess& guess) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(transcription.variables());
  const auto put = [&](int at, double s) {
    const State<double> x = guess.state(s);
    x.copy_to(&z[at]);
    if constexpr (F.rate)
      z.segment<kControls>(at + kStates) = Eigen::Map<const Eigen::Vector2d>(guess.torque(s).data());
    if constexpr (F.peak) {
      constexpr int kPeak = ArmOcp<F>::kPeak;
      z.segment<kJoints>(at + kPeak) = transcription.x_upper.template segment<kJoints>(at + kPeak);
    }
    if constexpr (F.slack) z(at + ArmOcp<F>::kSlack) = transcription.x_upper(at + ArmOcp<F>::kSlack) / 2;
  };
  const std::vector<double> times = transcription.mesh().node_times(guess.durations);
  put(0, 0);
  for (int k = 0; k < transcription.intervals(); ++k) {
    const double from = times[static_cast<std::size_t>(k)], to = times[static_cast<std::size_t>(k) + 1];
    if constexpr (!F.rate) {
      for (int end = 0; end < 2; ++end) {
        const Joints<double> u = guess.torque((from + (end == 0 ? kInside : 1 - kInside) * (to - from)) / times.back());
        z.segment<kControls>(transcription.u_at(k, end)) = Eigen::Map<const Eigen::Vector2d>(u.data());
      }
    }
    for (int j = 0; j < transcription.scheme().stages(); ++j) {
      const double c = transcription.scheme().points(j), s = (from + c * (to - from)) / times.back();
      if (transcription.x_at(k, j) != transcription.node_at(k)) put(transcription.x_at(k, j), s);
    }
  }
  for (int s = 0; s < transcription.mesh().segments(); ++s) {
    z(transcription.duration_at(s)) = guess.durations[static_cast<std::size_t>(s)];
  }
  return {z, {}, {}, {}};
}

template <Features F>
Collocated run(const CollocationSetup& setup, Transcription<ArmOcp<F>>& transcription, const Iterate& start,
               const SolveOptions& options) {
  transcription.both = options.both;
  Collocated result{setup, solve(transcription, start, options), {}, {}};
  if (result.report.iterate.x.size() == transcription.variables()) {
    result.durations = transcription.durations(result.report.iterate.x);
    result.motion = motion_of(transcription, result.report.iterate.x);
    if constexpr (F.slack) result.slack = result.report.iterate.x(ArmOcp<F>::kSlack);
    if constexpr (F.peak) {
      for (std::size_t j = 0; j < kJoints && transcription.ocp().weights.peak_torque > 0; ++j) {
        result.peak[j] = result.report.iterate.x(ArmOcp<F>::kPeak + static_cast<int>(j));
      }
    }
  }
  return result;
}

inline bool fits(const Nlp& nlp, const Iterate& iterate) {
  return iterate.x.size() == nlp.variables() && iterate.lambda.size() == nlp.constraints() &&
         iterate.z_lower.size() == nlp.variables() && iterate.z_upper.size() == nlp.variables();
}

}  // namespace arm_collocation

template <Features F>
Collocated collocate_with(const Problem& problem, const CollocationSetup& setup, const Guess* guess,
                          const Collocated* start, const SolveOptions& options) {
  namespace parts = arm_collocation;
  auto transcription = parts::transcribe<F>(problem, setup);
  if (guess) return parts::run(setup, transcription, parts::evaluate_guess(transcription, *guess), options);
  const Iterate& iterate = start->report.iterate;
  if (setup.mesh == start->setup.mesh) {
    if (!parts::fits(transcription, iterate)) return {setup, {}, {}, {}};
    return parts::run(setup, transcription, iterate, options);
  }
  const auto before = parts::transcribe<F>(problem, start->setup);
  if (!parts::fits(before, iterate)) return {setup, {}, {}, {}};
  return parts::run(setup, transcription, Transfer<ArmOcp<F>>(before, iterate, transcription).run(), options);
}

// Explicit instantiation: the functions that several files use are compiled once per instance, in the instance's file.
#define FJR_ARM_COLLOCATION(EXTERN, FEATURES)                                                                     \
  EXTERN template class Transcription<ArmOcp<FEATURES>>;                                                          \
  EXTERN template Adjoint adjoint(const Transcription<ArmOcp<FEATURES>>&, const Iterate&);                        \
  EXTERN template Transcription<ArmOcp<FEATURES>> arm_collocation::transcribe<FEATURES>(const Problem&,           \
                                                                                        const CollocationSetup&); \
  EXTERN template Collocated arm_collocation::run(const CollocationSetup&, Transcription<ArmOcp<FEATURES>>&,      \
                                                  const Iterate&, const SolveOptions&);                           \
  EXTERN template Collocated collocate_with<FEATURES>(const Problem&, const CollocationSetup&, const Guess*,      \
                                                      const Collocated*, const SolveOptions&);

FJR_ARM_COLLOCATION(extern, kPlain)
FJR_ARM_COLLOCATION(extern, kWithTask)
FJR_ARM_COLLOCATION(extern, kRateWithTask)
FJR_ARM_COLLOCATION(extern, kWithPeak)
FJR_ARM_COLLOCATION(extern, kEverything)
FJR_ARM_COLLOCATION(extern, kSlackTask)
FJR_ARM_COLLOCATION(extern, kSlackEverything)

}  // namespace fjr
