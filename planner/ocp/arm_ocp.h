// The arm's optimal control problem: dynamics, running cost and path constraints.
//
// The control is the friction-compensated torque u = tau_m - tau_fm_nonlinear(dtheta), eq. (26). The dynamics are
// smooth in it. The friction law appears only in the output tau_m = u + tau_fm_nonlinear(dtheta), that is in the torque
// limit and in the effort, and is smoothed there during the homotopy in friction.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "model/dynamics.h"
#include "model/kinematics.h"
#include "planner/collocation/transcription.h"
#include "planner/problem/problem.h"
#include "planner/problem/task/task.h"

namespace fjr {

// The features that an instance of ArmOcp supports. Unused ones would only cost computing time.
struct Features {
  bool rate = false;   // u is a state and its rate the control, so that u is continuous and its rate may be limited and
                       // penalised; otherwise u is the control and may jump
  int task_rows = 0;   // number of path constraints for the task; if > 0, goals with a free joint are supported too
  bool peak = false;   // an upper bound on |tau_m| per motor is a state, so that it can be penalised; needs task rows
  bool slack = false;  // supports ProblemVariation::slack
};

// Returns the index of the first path constraint of a quantity that is bounded by path constraints.
constexpr int row_of(const QuantityInfo& info) {
  int row = 0;
  for (const QuantityInfo& other : Quantities::infos) {
    if (same_quantity(other, info)) break;
    if (other.bound == BoundOn::kRow) row += static_cast<int>(other.count());
  }
  return row;
}
inline constexpr int kQuantityRows = [] {
  int rows = 0;
  for (const QuantityInfo& info : Quantities::infos) {
    if (info.bound == BoundOn::kRow) rows += static_cast<int>(info.count());
  }
  return rows;
}();

template <Features F>
struct ArmOcp {
  static constexpr int kArm = fjr::kStates;
  static constexpr int kPeak = kArm + (F.rate ? kJoints : 0);  // index of the first of the states for Features::peak
  static constexpr int kSlack = kPeak + (F.peak ? kJoints : 0);
  static constexpr int kStates = kSlack + (F.slack ? 1 : 0);
  static constexpr int kControls = kJoints;
  // Indices of path constraints. Those of limited quantities come first; row_of() returns their places. kEquilibrium:
  // theta - q - G(q) / K of each joint, zero at rest. kPeakRow: peak - tau_m and peak + tau_m of each joint.
  static constexpr int kEquilibrium = kQuantityRows, kPeakRow = kEquilibrium + kJoints;
  static constexpr int kTask = kPeakRow + (F.peak ? 2 * kJoints : 0);
  static_assert(!F.peak || F.task_rows > 0);
  // With a slack there are two more constraints per limit and per task constraint (in this order), value - slack and
  // value + slack, and one per joint for the velocity that may be lower.
  static constexpr int kRelaxed = F.task_rows > 0 ? kTask + F.task_rows : kEquilibrium;
  static constexpr int kLimited = static_cast<int>(kLimits) + F.task_rows;
  static constexpr int kRelaxedVelocity = kRelaxed + 2 * kLimited;
  static constexpr int kRows = F.slack ? kRelaxedVelocity + kJoints : kRelaxed;
  static constexpr auto kRowUsesControl = [] {
    std::array<bool, kRows> uses{};
    for (std::size_t i = kPeakRow; i < kTask && i < uses.size(); ++i) uses[i] = !F.rate;
    for (std::size_t i = 0; i < kLimits; ++i) {
      const QuantityInfo& info = *kLimitNames[i].quantity;
      const bool sees = info.bound == BoundOn::kControl ? F.rate : info.sees_torque && !F.rate;
      if (info.bound == BoundOn::kRow) uses[row_of(info) + kLimitNames[i].j()] = sees;
      if (F.slack) uses[kRelaxed + 2 * i] = uses[kRelaxed + 2 * i + 1] = sees;
    }
    return uses;
  }();
  static constexpr auto kRowOfSegment = [] {
    std::array<bool, kRows> of_segment{};
    for (std::size_t i = kTask; i < kRelaxed; ++i) of_segment[i] = true;
    for (std::size_t i = kRelaxed + 2 * kLimits; i < of_segment.size(); ++i) of_segment[i] = true;
    return of_segment;
  }();
  static constexpr double kRateUnit = 100;  // [N m/s] per unit of control: keeps the controls near the states' size

  Parameters robot;
  Weights weights;
  Joints<FrictionLaw> friction;             // used in the torque limit and the effort
  std::vector<std::vector<TaskRow>> tasks;  // task constraints per segment; the same number in each
  Array<kLimited> relaxation{};             // by how much each limit is relaxed per unit of slack
  Limits limits;  // quantities without a finite limit are not evaluated; relaxing the limit of a square needs its value
  Joints<double> velocity_relaxation{};  // [rad/s] per unit of slack

  using Bounds = PathBounds<kStates, kControls, kRows>;
  std::vector<Bounds> bounds;
  std::vector<NodeBounds<kStates>> at_nodes;
  std::vector<RowBounds> rows_at_nodes;
  std::vector<std::array<double, 2>> durations;
  std::vector<DurationSum> duration_sums;
  double time_weight = 0;
  struct CostNode {
    std::size_t node;
    Node kind;
  };
  std::vector<CostNode> cost_nodes;
  std::vector<PointCost<kStates + kControls>> point_costs;  // represent ProblemVariation::price
  double kink = 0;                                          // [W] see Instant
  double regularisation = 0;  // weight of int u^2, not part of the reported objective: see make_arm_ocp()

  // Evaluates the problem at a point. x (kStates): q, dq, theta, dtheta; with F.rate the torque u [N m], with F.peak
  // the peaks [N m], with F.slack the slack. u (kControls): the friction-compensated torque [N m]; with F.rate its
  // rate, in units of kRateUnit. f (kStates): dx/dt. cost: the weighted running cost per second, the regularisation
  // included. rows (kRows): of limits and of the task in this segment; those of quantities without a limit are not
  // written.
  template <class T>
  void evaluate(int segment, const T* x, const T* u, T* f, T& cost, T* rows) const {
    const auto state = State<T>::from(x);
    const State<T> rate = compensated_dynamics(robot, state, compensated(x, u));
    for (int i = 0; i < kArm; ++i) f[i] = rate[i];
    if constexpr (F.rate) {
      for (int j = 0; j < kJoints; ++j) f[kArm + j] = kRateUnit * u[j];
    }
    if constexpr (F.peak) {
      for (std::size_t j = 0; j < kJoints; ++j) f[kPeak + j] = T(0.0);
    }
    if constexpr (F.slack) f[kSlack] = T(0.0);
    const Joints<T> nonlinear{friction[0].nonlinear(state.dtheta[0]), friction[1].nonlinear(state.dtheta[1])};
    cost_and_rows(segment, state, x, u, rate.dq, nonlinear, cost, rows);
  }

  // Expensive terms that depend on the state alone, with first and second derivatives in closed form. Collocation
  // points with the same state share them.
  struct AtState {
    LinkDerivatives acceleration;
    Joints<FrictionLaw::Derivatives> friction;
  };
  AtState at_state(const double* x) const {
    const auto state = State<double>::from(x);
    return {
        derivatives_of_link_acceleration<true>(robot, state.q, state.dq, state.theta),
        {friction[0].derivatives_of_nonlinear(state.dtheta[0]), friction[1].derivatives_of_nonlinear(state.dtheta[1])}};
  }

  // Computes f and its derivatives. Entries that are always zero are not written, so *f must hold zeros or the results
  // at another point.
  void dynamics(const AtState& at, const double* x, const double* u, Dual<kStates + kControls>* f) const {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const std::size_t q = kStateQ + j, dq = kStateDq + j, theta = kStateTheta + j, dtheta = kStateDtheta + j;
      const std::size_t torque = F.rate ? kArm + j : kStates + j;
      f[q].v = x[dq];
      f[q].g[dq] = 1;
      f[dq].v = at.acceleration.value[j];
      std::copy(at.acceleration.first[j].begin(), at.acceleration.first[j].end(), f[dq].g.begin());
      f[theta].v = x[dtheta];
      f[theta].g[dtheta] = 1;
      const double stiffness = robot.spring.stiffness[j], viscous = robot.friction.viscous[j];
      const double inverse = 1 / robot.motor.inertia[j];
      f[dtheta].v = inverse * (compensated(x, u)[j] - stiffness * (x[theta] - x[q]) - viscous * x[dtheta]);
      f[dtheta].g[q] = inverse * stiffness;
      f[dtheta].g[theta] = -inverse * stiffness;
      f[dtheta].g[dtheta] = -inverse * viscous;
      f[dtheta].g[torque] = inverse;
      if constexpr (F.rate) {
        f[kArm + j].v = kRateUnit * u[j];
        f[kArm + j].g[kStates + j] = kRateUnit;
      }
    }
  }

  // Computes the running cost and the path constraints of evaluate(), with derivatives.
  template <CarriesValues D>
  void cost_and_rows(int segment, const AtState& at, const D* x, const D* u, D& cost, D* rows) const {
    const auto state = State<D>::from(x);
    const Joints<D> ddq = sees_acceleration(weights) ? link_acceleration(at.acceleration, state) : Joints<D>{};
    const auto nonlinear = [&](std::size_t j) {
      const FrictionLaw::Derivatives& of = at.friction[j];
      return chain(state.dtheta[j], of.value, of.first, of.second);
    };
    cost_and_rows(segment, state, x, u, ddq, {nonlinear(0), nonlinear(1)}, cost, rows);
  }

  // Adds sum_r weight_r d2f_r/d(x, u)^2 to a lower triangle packed by rows. Only the accelerations of the links have
  // second derivatives.
  void add_curvature(const AtState& at, const double* weight, double* hessian) const {
    static_assert(kStateQ == 0 && kStateDq == kJoints && kStateTheta == 2 * kJoints);  // as LinkDerivatives has them
    for (std::size_t i = 0; i < kLinkPairs; ++i) {
      for (std::size_t j = 0; j < kJoints; ++j) hessian[i] += weight[kStateDq + j] * at.acceleration.second[j][i];
    }
  }

  // Returns the cost of the state at one of cost_nodes.
  template <class T>
  T node_cost(const CostNode& at, const T* x) const {
    const auto state = State<T>::from(x);
    Joints<T> peak{T(0.0), T(0.0)};
    if constexpr (F.peak) peak = {x[kPeak], x[kPeak + 1]};
    T cost = fjr::node_cost(weights, at.kind, AtNode<T>{robot, state, peak});
    if constexpr (F.slack) {
      if (at.kind == Node::kGoal) cost += x[kSlack];
    }
    return cost;
  }

 private:
  // Returns u [N m].
  template <class T>
  static Joints<T> compensated(const T* x, const T* u) {
    return F.rate ? Joints<T>{x[kArm], x[kArm + 1]} : Joints<T>{u[0], u[1]};
  }

  template <class T>
  void cost_and_rows(int segment, const State<T>& state, const T* x, const T* u, const Joints<T>& ddq,
                     const Joints<T>& nonlinear_friction, T& cost, T* rows) const {
    const Joints<T> compensated_torque = compensated(x, u);
    const Joints<T> torque{compensated_torque[0] + nonlinear_friction[0],
                           compensated_torque[1] + nonlinear_friction[1]};
    const Joints<T> torque_rate =
        F.rate ? Joints<T>{T(kRateUnit * u[0]), T(kRateUnit * u[1])} : Joints<T>{T(0.0), T(0.0)};
    const Moment<T> moment{robot, state, torque, torque_rate};
    quantity_rows(moment, rows);
    if constexpr (F.task_rows > 0) task(segment, state, rows);
    if constexpr (F.peak) {
      for (std::size_t j = 0; j < kJoints; ++j) {
        const T& peak = x[kPeak + j];
        rows[kPeakRow + 2 * j] = peak - torque[j];
        rows[kPeakRow + 2 * j + 1] = peak + torque[j];
      }
    }
    if constexpr (F.slack) relax_limits(moment, x[kSlack], rows);

    cost = running_cost(weights, Instant<T>{robot, state, ddq, torque, kink});
    if (regularisation > 0) cost += regularisation * sum_of_squares(compensated_torque);
    if constexpr (F.rate) {
      cost += weights.torque_rate * kRateUnit * kRateUnit * (u[0] * u[0] + u[1] * u[1]);
    }
  }

  // Returns whether a quantity is evaluated. Quantities with a limit of the robot always are, because goals with a free
  // joint need the spring deflections; the others are only if the request limits them.
  bool is_evaluated(const QuantityInfo& info) const { return info.of_robot || is_limited(info, limits); }

  template <class T>
  void quantity_rows(const Moment<T>& moment, T* rows) const {
    Quantities::visit([&](auto quantity) {
      if constexpr (quantity.info.bound == BoundOn::kRow) {
        if (!is_evaluated(quantity.info)) return;
        const auto values = quantity.value(moment);
        std::copy(values.begin(), values.end(), rows + row_of(quantity.info));
      }
    });
  }

  template <class T>
  void task(int segment, const State<T>& state, T* rows) const {
    const Joints<T> gravity = gravity_torque(robot, state.q);
    for (std::size_t j = 0; j < kJoints; ++j) {
      rows[kEquilibrium + j] = state.theta[j] - state.q[j] - gravity[j] / robot.spring.stiffness[j];
    }
    if (tasks.empty()) return;
    const auto posture = Posture<T>::of(robot, state.q);
    T* row = rows + kTask;
    for (const TaskRow& r : tasks[static_cast<std::size_t>(segment)]) *row++ = r.value(robot, posture);
  }

  template <class T>
  void relax_limits(const Moment<T>& moment, const T& slack, T* rows) const {
    std::size_t next = 0;
    const auto put = [&](const T& value, const T& by) {
      rows[kRelaxed + 2 * next] = value - by;
      rows[kRelaxed + 2 * next + 1] = value + by;
      ++next;
    };
    Quantities::visit([&](auto quantity) {
      if (!is_evaluated(quantity.info)) {
        next += quantity.info.count();
        return;
      }
      const auto values = quantity.value(moment);
      for (std::size_t j = 0; j < values.size(); ++j) {
        const T more = relaxation[next] * slack;
        // (limit + more)^2 - limit^2
        put(values[j], quantity.info.squared ? T(more * (2 * quantity.info.in(limits, j) + more)) : more);
      }
    });
    for (int r = 0; r < F.task_rows; ++r) put(rows[kTask + r], T(relaxation[next] * slack));
    for (std::size_t j = 0; j < kJoints; ++j)
      rows[kRelaxedVelocity + j] = moment.x.dq[j] + velocity_relaxation[j] * slack;
  }
};

// Returns the factor that a limit is divided by if it bounds a control, otherwise 1.
template <Features F>
double unit_of_bound(const QuantityInfo& info) {
  return info.bound == BoundOn::kControl ? ArmOcp<F>::kRateUnit : 1;
}

// Returns the lower and upper bound that represent limit i, or task constraint i - kLimits.
template <Features F>
std::array<double*, 2> bounds_of(typename ArmOcp<F>::Bounds& b, std::size_t i) {
  const auto row = [&b](std::size_t r) { return std::array{&b.row_lower[r], &b.row_upper[r]}; };
  if (i >= kLimits) return row(ArmOcp<F>::kTask + (i - kLimits));
  const QuantityInfo& info = *kLimitNames[i].quantity;
  const std::size_t j = kLimitNames[i].j(), x = static_cast<std::size_t>(info.state) + j;
  if (info.bound == BoundOn::kState) return {&b.x_lower[x], &b.x_upper[x]};
  if (info.bound == BoundOn::kControl) return {&b.u_lower[j], &b.u_upper[j]};
  return row(static_cast<std::size_t>(row_of(info)) + j);
}

// Returns the limits as bounds on states, controls and path constraints.
template <Features F>
typename ArmOcp<F>::Bounds path_bounds(const Limits& limits) {
  typename ArmOcp<F>::Bounds b;
  for (std::size_t i = 0; i < kLimits; ++i) {
    const QuantityInfo& info = *kLimitNames[i].quantity;
    if (info.bound == BoundOn::kControl && !F.rate) continue;
    const double limit = kLimitNames[i].in(limits), unit = unit_of_bound<F>(info);
    const auto [lower, upper] = bounds_of<F>(b, i);
    const double bound = (info.squared ? limit * limit : limit) / unit;
    const double middle = info.bound == BoundOn::kState ? info.counted_from(limits, kLimitNames[i].j()) : 0;
    *upper = middle + bound;
    if (!info.squared) *lower = middle - bound;
  }
  return b;
}

// Bounds the states for Features::peak and, if the peak is penalised, imposes |tau_m| <= peak less the margins [N m] of
// the torque limits. The lower bound of a peak is the gravity torque that holding the goal needs afterwards; a lower
// peak would not pay. (Where a joint may end anywhere, its holding torque counts only in the published value.)
template <Features F>
void bound_peaks(typename ArmOcp<F>::Bounds& b, const Problem& problem, const Joints<double>& margins) {
  using Ocp = ArmOcp<F>;
  constexpr double kBelowPeak = 1e-6;  // fraction of the limit; with equal bounds the state would become a constant
  const Joints<double> holding = held_at_goal(problem);
  for (std::size_t j = 0; j < kJoints; ++j) {
    b.x_lower[Ocp::kPeak + j] = std::min(holding[j], problem.limits.torque[j] * (1 - kBelowPeak));
    b.x_upper[Ocp::kPeak + j] = problem.limits.torque[j];
  }
  for (std::size_t r = Ocp::kPeakRow; r < Ocp::kTask && problem.weights.peak_torque > 0; ++r) {
    b.row_lower[r] = margins[(r - Ocp::kPeakRow) / 2];
  }
}

// Moves the bounds of relaxed limits to the two path constraints with the slack. These measure values from the middle
// of the range, as Quantity::value() does, so the middle is subtracted.
template <Features F>
void bound_with_slack(typename ArmOcp<F>::Bounds& b, const Limits& limits, const Slack& slack) {
  using Ocp = ArmOcp<F>;
  const auto middle_of = [&](std::size_t i) {
    return i < kLimits ? kLimitNames[i].quantity->counted_from(limits, kLimitNames[i].j()) : 0;
  };
  b.x_lower[Ocp::kSlack] = 0;
  b.x_upper[Ocp::kSlack] = slack.most;
  for (std::size_t i = 0; i < slack.direction.size(); ++i) {
    if (slack.direction[i] == 0) continue;
    const double unit = i < kLimits ? unit_of_bound<F>(*kLimitNames[i].quantity) : 1;
    const auto [lower, upper] = bounds_of<F>(b, i);
    b.row_upper[Ocp::kRelaxed + 2 * i] = unit * *upper - middle_of(i);
    b.row_lower[Ocp::kRelaxed + 2 * i + 1] = unit * *lower - middle_of(i);
    *lower = -kNoLimit;
    *upper = kNoLimit;
  }
}

// Returns an ArmOcp with the problem's plant and objective. Bounds, nodes and segments depend on the mesh and are left
// empty. regularisation: weight of the regularising effort, as a fraction of the weight of the objective; it limits how
// much objective the regularisation can cost.
template <Features F>
ArmOcp<F> make_arm_ocp(const Problem& problem, double regularisation) {
  ArmOcp<F> ocp;
  ocp.robot = problem.robot;
  ocp.weights = problem.weights;
  ocp.limits = problem.limits;
  ocp.time_weight = problem.weights.time;
  for (int j = 0; j < kJoints; ++j) ocp.friction[static_cast<std::size_t>(j)] = FrictionLaw::of(problem.robot, j);
  // In a minimum-time problem the torque is not unique for the joint that does not determine the time, and along
  // velocity limits; other terms leave it undetermined elsewhere. The optimiser would then return chattering torques
  // that samples cannot represent. The regularisation selects a smooth one.
  if (!settles_torque(problem.weights)) {
    const Joints<double>& limit = problem.limits.torque;
    ocp.regularisation =
        regularisation * objective_scale(problem.weights) / (limit[0] * limit[0] + limit[1] * limit[1]);
  }
  if constexpr (F.slack) {
    std::copy(problem.variation.slack->direction.begin(), problem.variation.slack->direction.end(),
              ocp.relaxation.begin());
    if (const auto at = problem.variation.slack->velocity) {
      const Joints<double> asked = *at < problem.via.size() ? *problem.via[*at].dq : problem.goal.dq;
      ocp.velocity_relaxation = asked;
    }
  }
  return ocp;
}

}  // namespace fjr
