// Transcribes an optimal control problem with a collocation scheme and a mesh to a nonlinear program, for any plant.
//
// An Ocp is a struct with
//   static constexpr int kStates, kControls, kRows;
//   static constexpr std::array<bool, kRows> kRowUsesControl;
//   template <class T>                                dx/dt, running cost, path rows
//   void evaluate(const T* x, const T* u, T* f, T& cost, T* rows) const;   or with `int segment` as first argument, if
//                                                     the formulas of some rows differ between the segments of the
//                                                     mesh (optional kRowOfSegment marks them); the inputs that a row
//                                                     depends on must not differ
//   struct AtState; AtState at_state(const double* x) const;
//                                                     optional, with the three that follow: intermediate results that
//                                                     depend on the state alone, for derivatives in closed form
//   void dynamics(const AtState&, const double* x, const double* u, Dual<kStates + kControls>* f) const;
//   template <class D> void cost_and_rows(int segment, const AtState&, const D* x, const D* u, D& cost, D* rows) const;
//                                                     the two parts of evaluate(); like evaluate() they may be given
//                                                     outputs that hold another point's results, and must overwrite
//                                                     the same entries every time
//   void add_curvature(const AtState&, const double* weight, double* hessian) const;
//                                                     adds sum_r weight_r d2f_r/d(x, u)^2 to the lower triangle that
//                                                     is packed by rows (Dual2)
//   std::vector<PathBounds<kStates, kControls, kRows>> bounds;  one for all intervals, or one per interval
//   std::vector<NodeBounds<kStates>> at_nodes;        start, goal, via points
//   std::vector<std::array<double, 2>> durations;     [s] bounds, one per segment of the mesh
//   std::vector<DurationSum> duration_sums;           bounds on sums of them
//   std::vector<RowBounds> rows_at_nodes;             optional: rows that hold at one node only
//   double time_weight;                               cost = time_weight T + int cost dt + cost at nodes
//   std::vector<PointCost<kStates + kControls>> point_costs;
//                                                     optional: costs at single collocation points, added to the
//                                                     running cost; none, or one per point of every interval
//   cost_nodes, a list with a member `node` each, and template <class T> T node_cost(const CostNode&, const T* x)
//   const;
//                                                     optional: cost of the state at the nodes in this list
//
// The state at every collocation point (a Runge-Kutta stage; "stage" in names) is a decision variable ("separated
// form"). The defects
//   y_i - y_0 - h sum_j A(i,j) f(y_j, u_j) = 0
// are then linear in f, so the Hessian of the Lagrangian has one small block per collocation point, and the rows of the
// durations.
// Controls are linear on their interval and may jump at every node (see Scheme::control_fraction).
//
// The decision variables are x_0, then per interval u_begin, u_end and the states y_j, then the durations. The chain
// factorisation (planner/nlp) relies on this order.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "common/dual.h"
#include "planner/collocation/interval_entries.h"
#include "planner/collocation/mesh.h"
#include "planner/collocation/ocp_members.h"
#include "planner/collocation/scheme.h"
#include "planner/nlp/nlp.h"

namespace fjr {

template <class Ocp>
class Transcription final : public Nlp {
 public:
  static constexpr int kX = Ocp::kStates, kU = Ocp::kControls, kC = Ocp::kRows, kV = kX + kU;

  Transcription(Ocp ocp, Scheme scheme, Mesh mesh)
      : ocp_(std::move(ocp)), scheme_(std::move(scheme)), mesh_(std::move(mesh)) {
    stages_ = scheme_.stages();
    first_new_ = scheme_.starts_at_node ? 1 : 0;
    find_structure();
    number_rows();
    set_bounds();
    set_patterns();
    set_blocks();
  }

  const Ocp& ocp() const { return ocp_; }
  const Scheme& scheme() const { return scheme_; }
  const Mesh& mesh() const { return mesh_; }
  int intervals() const { return static_cast<int>(mesh_.size()); }

  // Return the index of the first entry in the vector of decision variables. k: interval, j: collocation point.
  int x_at(int k, int j) const { return j < first_new_ ? node_at(k) : u_at(k, 2) + (j - first_new_) * kX; }
  int u_at(int k, int end) const { return interval_at(k) + end * kU; }  // end 0: u_begin, 1: u_end
  int node_at(int k) const { return k == 0 ? 0 : x_at(k - 1, stages_ - 1); }
  int duration_at(int segment) const { return interval_at(intervals()) + segment; }
  std::vector<double> durations(const In& z) const {
    std::vector<double> d;
    for (int s = 0; s < mesh_.segments(); ++s) d.push_back(z(duration_at(s)));
    return d;
  }

  // Duration of interval k [s].
  double step(const In& z, int k) const { return fraction(k) * z(duration_of(k)); }

  // Return the index among the constraints of: component r of the defect of stage i in interval k; path constraint c at
  // stage j, -1 if it is not imposed there; sum i of durations.
  int defect_row(int k, int i, int r) const { return interval_row_[index(k)] + (i - first_new_) * kX + r; }
  int path_row(int k, int j, int c) const { return path_rows_[index((k * stages_ + j) * kC + c)]; }
  int sum_row(std::size_t i) const { return first_sum_row_ + static_cast<int>(i); }

  // dx/dt, running cost and values of the path constraints at a collocation point.
  template <class T>
  struct Point {
    std::array<T, static_cast<std::size_t>(kX)> f;
    T cost{};
    std::array<T, static_cast<std::size_t>(kC)> rows;
  };
  using PointValues = Point<double>;
  PointValues values(const In& z, int k, int j) const {
    const Array<kV> v = stage_inputs(z, k, j);
    PointValues p;
    evaluate_at(k, j, v.data(), p);
    return p;
  }
  // Returns the values at every collocation point of every interval. Solvers ask for the objective and the constraints
  // at the same z one after the other, so the values at the last z are cached.
  const std::vector<PointValues>& all_values(const In& z) const {
    if (valued_at_.size() == z.size() && valued_at_ == z) return values_;
    values_.resize(index(intervals() * stages_));
    each_interval([&](int k, WorkSpace&) {
      for (int j = 0; j < stages_; ++j) {
        evaluate_at(k, j, stage_inputs(z, k, j).data(), values_[index(k * stages_ + j)]);
      }
    });
    valued_at_ = z;
    return values_;
  }

  // Returns the values with their derivatives by the state and the control. Solvers ask for the gradient, the Jacobian
  // and the Hessian at the same z one after the other, so the results at the last z are cached. Therefore only one
  // thread at a time may call an instance.
  using Derivatives = std::vector<Point<Dual<kV>>>;
  const Derivatives& first_derivatives(const In& z) const {
    if (derived_at_.size() == z.size() && derived_at_ == z) return derived_;
    derived_.resize(index(intervals() * stages_));
    if constexpr (kClosedForm) find_at_states(z);
    each_interval([&](int k, WorkSpace& space) {
      for (int j = 0; j < stages_; ++j) derive(z, k, j, space, derived_[index(k * stages_ + j)]);
    });
    derived_at_ = z;
    return derived_;
  }

  double objective(const In& z) const override {
    const auto& points = all_values(z);
    double total = 0;
    for (int s = 0; s < mesh_.segments(); ++s) total += ocp_.time_weight * z(duration_at(s));
    for (int k = 0; k < intervals(); ++k) {
      double sum = 0;
      for (int j = 0; j < stages_; ++j) sum += scheme_.b(j) * points[index(k * stages_ + j)].cost;
      total += step(z, k) * sum;
    }
    each_cost_node([&](const auto& at, int x) { total += node_value(at, z.data() + x); });
    return total;
  }

  void gradient(const In& z, Out out) const override {
    const auto& points = first_derivatives(z);
    out.setZero();
    for (int s = 0; s < mesh_.segments(); ++s) out(duration_at(s)) = ocp_.time_weight;
    for (int k = 0; k < intervals(); ++k) {
      const double h = step(z, k);
      for (int j = 0; j < stages_; ++j) {
        const auto& p = points[index(k * stages_ + j)];
        for (int i = 0; i < kV; ++i) {
          if (!structure_.cost.depends_on(i)) continue;
          spread(k, j, i,
                 [&](int at, double coefficient) { out(at) += coefficient * h * scheme_.b(j) * p.cost.g[index(i)]; });
        }
        out(duration_of(k)) += fraction(k) * scheme_.b(j) * p.cost.v;
      }
    }
    each_cost_node([&](const auto& at, int x) {
      const auto cost = node_derivatives<Dual<kX>>(at, z.data() + x);
      for (int i = 0; i < kX; ++i) out(x + i) += cost.g[index(i)];
    });
  }

  void constraint_values(const In& z, Out out) const override {
    const auto& points = all_values(z);
    each_interval([&](int k, WorkSpace&) {
      const double h = step(z, k);
      const PointValues* p = &points[index(k * stages_)];
      for (int i = first_new_; i < stages_; ++i) {
        for (int r = 0; r < kX; ++r) {
          double sum = 0;
          for (int j = 0; j < stages_; ++j) sum += scheme_.A(i, j) * p[j].f[index(r)];
          out(defect_row(k, i, r)) = z(x_at(k, i) + r) - z(node_at(k) + r) - h * sum;
        }
      }
      for (int j = 0; j < stages_; ++j) {
        for (int c = 0; c < kC; ++c) {
          if (path_row(k, j, c) >= 0) out(path_row(k, j, c)) = p[j].rows[index(c)];
        }
      }
    });
    for (std::size_t i = 0; i < sums(); ++i) {
      out(sum_row(i)) = 0;
      each_summed(i, [&](int segment) { out(sum_row(i)) += z(duration_at(segment)); });
    }
  }

  void jacobian(const In& z, Out out) const override {
    const auto& points = first_derivatives(z);
    each_interval([&](int k, WorkSpace&) {
      write_jacobian(k, step(z, k), &points[index(k * stages_)], out.data() + interval_jacobian_[index(k)]);
    });
    double* next = out.data() + interval_jacobian_.back();
    for (std::size_t i = 0; i < sums(); ++i) each_summed(i, [&](int) { *next++ = 1; });
  }

  void hessian(const In& z, double cost_factor, const In& multipliers, Out out) const override {
    const auto& points = first_derivatives(z);
    each_interval([&](int k, WorkSpace& space) {
      double* next = out.data() + interval_hessian_[index(k)];
      for (int j = 0; j < stages_; ++j) {
        next = write_hessian(k, j, z, points[index(k * stages_ + j)], cost_factor, multipliers, space, next);
      }
    });
    double* next = out.data() + interval_hessian_.back();
    auto pairs = curved_at_nodes_.begin();
    each_cost_node([&](const auto& at, int x) {
      const auto cost = node_derivatives<Dual2<kX>>(at, z.data() + x);
      for (const auto& [i, j] : *pairs++) *next++ = cost_factor * cost.second(index(i), index(j));
    });
  }

  // Return the coefficients of the collocation polynomials of interval k in powers of c in [0, 1], lowest degree first:
  // y(c) = y_0 + h sum_j f_j int_0^c l_j (kX x stages + 1) and u(c) = (1 - c) u_begin + c u_end (kU x 2).
  Eigen::Matrix<double, kX, Eigen::Dynamic> state_polynomial(const In& z, int k) const {
    Eigen::Matrix<double, kX, Eigen::Dynamic> y = Eigen::Matrix<double, kX, Eigen::Dynamic>::Zero(kX, stages_ + 1);
    y.col(0) = z.template segment<kX>(node_at(k));
    for (int j = 0; j < stages_; ++j) {
      const PointValues p = values(z, k, j);
      const Eigen::Map<const Eigen::Matrix<double, kX, 1>> f(p.f.data());
      for (int d = 0; d < stages_; ++d) y.col(d + 1) += step(z, k) * scheme_.lagrange(j, d) / (d + 1) * f;
    }
    return y;
  }
  Eigen::Matrix<double, kU, 2> control_polynomial(const In& z, int k) const {
    const auto begin = z.template segment<kU>(u_at(k, 0)), end = z.template segment<kU>(u_at(k, 1));
    Eigen::Matrix<double, kU, 2> u;
    u << begin, end - begin;
    return u;
  }

  // Sets Nlp::shift_weights for objectives that have no second derivatives by the controls, such as the shortest time.
  // Where the inertia correction shifts the Hessian, controls and durations get the full shift, and the states, which
  // they determine through the dynamics, only a hundredth. With equal shifts, Newton's method takes 1.4 times as many
  // iterations (bench/README.md, Races).
  void let_states_follow() {
    constexpr double kOfStates = 0.01;
    shift_weights = Eigen::VectorXd::Constant(variables(), kOfStates);
    for (int k = 0; k < intervals(); ++k) shift_weights.segment(u_at(k, 0), 2 * kU).setOnes();
    shift_weights.tail(mesh_.segments()).setOnes();
  }

 private:
  static constexpr std::size_t index(int i) { return static_cast<std::size_t>(i); }
  static constexpr bool kClosedForm = HasClosedForm<Ocp>;

  int interval_at(int k) const { return kX + k * (2 * kU + (stages_ - first_new_) * kX); }
  // Scratch memory of one evaluating thread.
  struct WorkSpace {
    Inputs<Dual<kV>> inputs;
    Inputs<Dual2<kV>> curved_inputs;
    Point<Dual2<kV>> curved_point;
  };
  // Calls visit(k, work space) for every interval. The two halves of the mesh run concurrently if `both` does so.
  template <class Visit>
  void each_interval(Visit&& visit) const {
    const int middle = intervals() / 2;
    const auto visit_all = [&visit](int from, int to, WorkSpace& space) {
      for (int k = from; k < to; ++k) visit(k, space);
    };
    auto first_half = [&] { visit_all(0, middle, work_spaces_[0]); };
    auto second_half = [&] { visit_all(middle, intervals(), work_spaces_[1]); };
    both(std::ref(first_half), std::ref(second_half));
  }

  // Calls visit(variable, d(input)/d(variable)) for every variable that input i of stage j, a state or a control,
  // depends on.
  template <class Visit>
  void spread(int k, int j, int i, Visit&& visit) const {
    if (i < kX) return visit(x_at(k, j) + i, 1.0);
    for (int end = 0; end < 2; ++end) {
      if (scheme_.control_fraction(j, end) != 0) visit(u_at(k, end) + i - kX, scheme_.control_fraction(j, end));
    }
  }
  // Returns the state and the control at collocation point j.
  Array<kV> stage_inputs(const In& z, int k, int j) const {
    Array<kV> v = filled<kV>(0);
    for (int i = 0; i < kV; ++i)
      spread(k, j, i, [&](int at, double coefficient) { v[index(i)] += coefficient * z(at); });
    return v;
  }
  const auto& bounds_in(int k) const { return ocp_.bounds.size() == 1 ? ocp_.bounds[0] : ocp_.bounds[index(k)]; }
  double fraction(int k) const { return mesh_.intervals[index(k)].fraction; }
  int duration_of(int k) const { return duration_at(mesh_.intervals[index(k)].segment); }

  template <class T>
  void evaluate_at(int k, int j, const T* v, Point<T>& p) const {
    const int segment = mesh_.intervals[index(k)].segment;
    if constexpr (requires { ocp_.evaluate(segment, v, v, p.f.data(), p.cost, p.rows.data()); }) {
      ocp_.evaluate(segment, v, v + kX, p.f.data(), p.cost, p.rows.data());
    } else {
      ocp_.template evaluate<T>(v, v + kX, p.f.data(), p.cost, p.rows.data());
    }
    add_point_cost(k, j, v, p.cost);
  }
  template <class T>
  void add_point_cost(int k, int j, const T* v, T& cost) const {
    if constexpr (requires { ocp_.point_costs; }) {
      if (!ocp_.point_costs.empty()) cost += ocp_.point_costs[index(k * stages_ + j)].of(v);
    }
  }

  // Calls visit(cost node, index of the first variable of its state).
  template <class Visit>
  void each_cost_node(Visit&& visit) const {
    if constexpr (requires { ocp_.cost_nodes; }) {
      for (const auto& at : ocp_.cost_nodes) visit(at, node_at(static_cast<int>(at.node)));
    }
  }
  template <class CostNode>  // so that problems without cost nodes need no node_cost()
  double node_value(const CostNode& at, const double* x) const {
    return ocp_.node_cost(at, x);
  }
  template <class D, class At>
  D node_derivatives(const At& at, const double* values) const {
    std::array<D, static_cast<std::size_t>(kX)> x;
    for (int i = 0; i < kX; ++i) x[index(i)] = D::input(values[i], i);
    return ocp_.node_cost(at, x.data());
  }

  void derive(const In& z, int k, int j, WorkSpace& space, Point<Dual<kV>>& p) const {
    const Array<kV> values = stage_inputs(z, k, j);
    const Dual<kV>* v = space.inputs.at(values);
    if constexpr (kClosedForm) {
      ocp_.dynamics(at_state(k, j), values.data(), values.data() + kX, p.f.data());
      cost_and_rows_at(k, j, v, p);
    } else {
      evaluate_at(k, j, v, p);
    }
  }
  template <class D>
  void cost_and_rows_at(int k, int j, const D* v, Point<D>& p) const {
    ocp_.cost_and_rows(mesh_.intervals[index(k)].segment, at_state(k, j), v, v + kX, p.cost, p.rows.data());
    add_point_cost(k, j, v, p.cost);
  }

  // Evaluates the closed forms once per state. If the scheme has a collocation point at the start of an interval, it
  // shares the state of the last point of the interval before.
  using AtState = AtStateOf<Ocp>;
  void find_at_states(const In& z) const {
    const int each = stages_ - first_new_;
    at_states_.resize(index(1 + intervals() * each));
    const auto set = [&](int at, int x) { at_states_[index(at)] = ocp_.at_state(z.data() + x); };
    set(0, node_at(0));
    each_interval([&](int k, WorkSpace&) {
      for (int i = 0; i < each; ++i) set(1 + k * each + i, x_at(k, first_new_ + i));
    });
  }
  const AtState& at_state(int k, int j) const {
    return at_states_[index(k * (stages_ - first_new_) + j + 1 - first_new_)];
  }

  // Returns whether a path constraint has the same formula in intervals k and l. One that depends on the segment has
  // not if the intervals lie in different segments.
  bool means_the_same(int row, int k, int l) const {
    if constexpr (requires { Ocp::kRowOfSegment; }) {
      return !Ocp::kRowOfSegment[index(row)] || mesh_.intervals[index(k)].segment == mesh_.intervals[index(l)].segment;
    }
    return true;
  }
  std::size_t sums() const { return ocp_.duration_sums.size(); }
  template <class Visit>
  void each_summed(std::size_t i, Visit&& visit) const {
    for (int s = ocp_.duration_sums[i].first; s <= ocp_.duration_sums[i].last; ++s) visit(s);
  }
  // Calls visit(bounds) for the bounds that a path constraint has only at the node at the end of interval k.
  template <class Visit>
  void each_at_end(int k, int row, Visit&& visit) const {
    if constexpr (requires { ocp_.rows_at_nodes; }) {
      for (const RowBounds& at : ocp_.rows_at_nodes) {
        if (at.row == row && at.node == index(k + 1)) visit(at);
      }
    }
  }

  // A path constraint without bounds is left out. One that does not depend on the control is imposed once per state,
  // and not at all where every state it depends on is fixed: at the start, or at a node with fixed states.
  void number_rows() {
    std::vector<std::uint32_t> given(mesh_.size() + 1, 0);  // bit i: state i is fixed at that node
    for (const auto& at : ocp_.at_nodes) {
      for (int i = 0; i < kX; ++i) {
        if (at.lower[index(i)] == at.upper[index(i)]) given[at.node] |= 1U << i;
      }
    }
    int next = 0;
    for (int k = 0; k < intervals(); ++k) {
      interval_row_.push_back(next);
      next += (stages_ - first_new_) * kX;
      for (int j = 0; j < stages_; ++j) {
        for (int c = 0; c < kC; ++c) {
          bool bounded = bounds_in(k).row_lower[index(c)] > -std::numeric_limits<double>::infinity() ||
                         bounds_in(k).row_upper[index(c)] < std::numeric_limits<double>::infinity();
          if (j + 1 == stages_) each_at_end(k, c, [&](const RowBounds&) { bounded = true; });
          const bool known = j + 1 == stages_ && (structure_.rows[index(c)].g & ~given[index(k + 1)]) == 0;
          const bool asked = bounded && (Ocp::kRowUsesControl[index(c)] || (j >= first_new_ && !known));
          path_rows_.push_back(asked ? next++ : -1);
        }
      }
    }
    first_sum_row_ = next;
    rows_ = next + static_cast<int>(sums());
  }

  void find_structure() {
    std::array<Pattern<kV>, static_cast<std::size_t>(kV)> v;
    for (int i = 0; i < kV; ++i) v[index(i)] = Pattern<kV>::input(1, i);
    evaluate_at(0, 0, v.data(), structure_);
    if constexpr (requires { ocp_.point_costs; }) {
      for (const auto& at : ocp_.point_costs) structure_.cost += at.of(v.data());
    }
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < kV; ++i) {
      for (int j = 0; j <= i; ++j) {
        bool curved = structure_.cost.curved_in(i, j);
        for (const auto& f : structure_.f) curved = curved || f.curved_in(i, j);
        for (const auto& row : structure_.rows) curved = curved || row.curved_in(i, j);
        if (curved) pairs.emplace_back(i, j);
      }
    }
    entries_ = IntervalEntries<kX, kU, kC>(scheme_, structure_, pairs);
    const Array<kX> anywhere = filled<kX>(1);
    each_cost_node([&](const auto& at, int) {
      const auto cost = node_derivatives<Pattern<kX>>(at, anywhere.data());
      auto& of_node = curved_at_nodes_.emplace_back();
      for (int i = 0; i < kX; ++i) {
        for (int j = 0; j <= i; ++j) {
          if (cost.curved_in(i, j)) of_node.emplace_back(i, j);
        }
      }
    });
  }

  void set_bounds() {
    set_variable_bounds();
    set_row_bounds();
  }

  void set_variable_bounds() {
    const int n = duration_at(mesh_.segments());
    x_lower = Eigen::VectorXd::Constant(n, -std::numeric_limits<double>::infinity());
    x_upper = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
    if (first_new_ == 0) {  // the start is no collocation point of such a scheme
      std::copy_n(bounds_in(0).x_lower.begin(), kX, x_lower.begin());
      std::copy_n(bounds_in(0).x_upper.begin(), kX, x_upper.begin());
    }
    for (int k = 0; k < intervals(); ++k) {
      const auto& bounds = bounds_in(k);
      for (int j = 0; j < stages_; ++j) {
        for (int i = 0; i < kV; ++i) {
          spread(k, j, i, [&](int at, double) {  // a node belongs to two intervals: the tighter bound holds
            x_lower(at) = std::max(x_lower(at), i < kX ? bounds.x_lower[index(i)] : bounds.u_lower[index(i - kX)]);
            x_upper(at) = std::min(x_upper(at), i < kX ? bounds.x_upper[index(i)] : bounds.u_upper[index(i - kX)]);
          });
        }
      }
    }
    for (const auto& bounds : ocp_.at_nodes) {
      for (int r = 0; r < kX; ++r) {
        double& lower = x_lower(node_at(static_cast<int>(bounds.node)) + r);
        double& upper = x_upper(node_at(static_cast<int>(bounds.node)) + r);
        const double low = bounds.lower[index(r)], high = bounds.upper[index(r)];
        // A fixed value holds exactly, even if it violates a path bound that was tightened by a margin.
        lower = low == high ? low : std::max(lower, low);
        upper = low == high ? high : std::min(upper, high);
      }
    }
    for (int s = 0; s < mesh_.segments(); ++s) {
      x_lower(duration_at(s)) = ocp_.durations[index(s)][0];
      x_upper(duration_at(s)) = ocp_.durations[index(s)][1];
    }
  }

  void set_row_bounds() {
    g_lower = Eigen::VectorXd::Zero(rows_);
    g_upper = Eigen::VectorXd::Zero(rows_);
    for (int k = 0; k < intervals(); ++k) {
      for (int j = 0; j < stages_; ++j) {
        for (int c = 0; c < kC; ++c) {
          if (path_row(k, j, c) < 0) continue;
          double& lower = g_lower(path_row(k, j, c));
          double& upper = g_upper(path_row(k, j, c));
          lower = bounds_in(k).row_lower[index(c)];
          upper = bounds_in(k).row_upper[index(c)];
          // A path constraint on the state at a node shared by two intervals is imposed once, with the tighter bounds.
          const bool shared = !Ocp::kRowUsesControl[index(c)] && first_new_ == 1 && j + 1 == stages_;
          if (shared && k + 1 < intervals() && means_the_same(c, k, k + 1)) {
            lower = std::max(lower, bounds_in(k + 1).row_lower[index(c)]);
            upper = std::min(upper, bounds_in(k + 1).row_upper[index(c)]);
          }
          if (j + 1 < stages_) continue;
          each_at_end(k, c, [&](const RowBounds& at) {
            lower = std::max(lower, at.lower);
            upper = std::min(upper, at.upper);
          });
        }
      }
    }
    for (std::size_t i = 0; i < sums(); ++i) {
      g_lower(sum_row(i)) = ocp_.duration_sums[i].lower;
      g_upper(sum_row(i)) = ocp_.duration_sums[i].upper;
    }
  }

  void set_patterns() {
    for (int k = 0; k < intervals(); ++k) {
      interval_jacobian_.push_back(jacobian_pattern.size());
      for (const DefectEntry& e : entries_.defects) {
        jacobian_pattern.push_back({defect_row(k, e.defect, e.row), variable(k, e.of)});
      }
      for (int j = 0; j < stages_; ++j) {
        for (int c = 0; c < kC; ++c) {
          if (path_row(k, j, c) < 0) continue;
          for (const InputEntry& e : entries_.rows[index(j * kC + c)]) {
            jacobian_pattern.push_back({path_row(k, j, c), variable(k, e.of)});
          }
        }
      }
    }
    interval_jacobian_.push_back(jacobian_pattern.size());
    for (std::size_t i = 0; i < sums(); ++i) {
      each_summed(i, [&](int segment) { jacobian_pattern.push_back({sum_row(i), duration_at(segment)}); });
    }
    for (int k = 0; k < intervals(); ++k) {
      interval_hessian_.push_back(hessian_pattern.size());
      for (int j = 0; j < stages_; ++j) {
        for (const PairEntry& e : entries_.pairs[index(j)]) {
          const int row = variable(k, e.of), col = variable(k, e.with);
          hessian_pattern.push_back({std::max(row, col), std::min(row, col)});
        }
        for (const InputEntry& e : entries_.with_duration[index(j)]) {
          hessian_pattern.push_back({duration_of(k), variable(k, e.of)});
        }
      }
    }
    interval_hessian_.push_back(hessian_pattern.size());
    auto pairs = curved_at_nodes_.begin();
    each_cost_node([&](const auto&, int x) {
      for (const auto& [i, j] : *pairs++) hessian_pattern.push_back({x + i, x + j});
    });
  }

  // Interval k, with the node at its end, is block k of the chain. The durations are the border: they couple with all.
  void set_blocks() {
    blocks = intervals();
    variable_block.assign(static_cast<std::size_t>(x_lower.size()), intervals());
    constraint_block.assign(static_cast<std::size_t>(rows_), intervals());
    std::fill_n(variable_block.begin(), kX, 0);
    for (int k = 0; k < intervals(); ++k) {
      std::fill(variable_block.begin() + interval_at(k), variable_block.begin() + interval_at(k + 1), k);
      const int end = k + 1 < intervals() ? interval_row_[index(k + 1)] : first_sum_row_;
      std::fill(constraint_block.begin() + interval_row_[index(k)], constraint_block.begin() + end, k);
    }
  }

  int variable(int k, const EntryVariable& v) const {
    if (v.where == EntryVariable::kDuration) return duration_of(k);
    return v.at + (v.where == EntryVariable::kNode ? node_at(k) : interval_at(k));
  }

  // Writes the entries of the constraints of interval k.
  void write_jacobian(int k, double h, const Point<Dual<kV>>* p, double* to) const {
    for (const DefectEntry& e : entries_.defects) {
      if (e.of.where == EntryVariable::kDuration) {
        double rate = 0;
        for (int j = 0; j < stages_; ++j) rate += scheme_.A(e.defect, j) * p[j].f[index(e.row)].v;
        *to++ = -fraction(k) * rate;
      } else {
        *to++ = e.own - h * e.factor * p[e.stage].f[index(e.row)].g[index(e.input)];
      }
    }
    for (int j = 0; j < stages_; ++j) {
      for (int c = 0; c < kC; ++c) {
        if (path_row(k, j, c) < 0) continue;
        const auto& gradient = p[j].rows[index(c)].g;
        for (const InputEntry& e : entries_.rows[index(j * kC + c)]) *to++ = e.coefficient * gradient[index(e.input)];
      }
    }
  }

  // Writes the Hessian entries of collocation point j in interval k, whose first derivatives are given, and returns the
  // position behind them.
  double* write_hessian(int k, int j, const In& z, const Point<Dual<kV>>& first, double cost_factor,
                        const In& multipliers, WorkSpace& space, double* to) const {
    const double h = step(z, k), cost_weight = cost_factor * scheme_.b(j);
    Array<kX> weight = filled<kX>(0);  // factor of f_j in the Lagrangian, divided by h
    for (int i = first_new_; i < stages_; ++i) {
      for (int r = 0; r < kX; ++r) weight[index(r)] -= scheme_.A(i, j) * multipliers(defect_row(k, i, r));
    }
    std::array<double, Dual2<kV>::kHessian> block{};
    add_second_derivatives(k, j, z, h, h * cost_weight, weight, multipliers, space, block);
    for (const PairEntry& e : entries_.pairs[index(j)]) *to++ = e.coefficient * block[e.packed];
    Array<kV> cross;
    for (std::size_t i = 0; i < kV; ++i) cross[i] = cost_weight * first.cost.g[i];
    for (std::size_t r = 0; r < kX; ++r) {
      for (std::size_t i = 0; i < kV; ++i) cross[i] += weight[r] * first.f[r].g[i];
    }
    for (const InputEntry& e : entries_.with_duration[index(j)])
      *to++ = e.coefficient * fraction(k) * cross[index(e.input)];
    return to;
  }

  // Adds the second derivatives of cost_weight L + h weight' f + multipliers' rows at collocation point j to `block`.
  void add_second_derivatives(int k, int j, const In& z, double h, double cost_weight, const Array<kX>& weight,
                              const In& multipliers, WorkSpace& space,
                              std::array<double, Dual2<kV>::kHessian>& block) const {
    const auto accumulate = [&block](double w, const Dual2<kV>& d) {
      if (w == 0) return;
      d.each([&](std::size_t, std::size_t, std::size_t at) { block[at] += w * d.h[at]; });
    };
    const Dual2<kV>* v = space.curved_inputs.at(stage_inputs(z, k, j));
    Point<Dual2<kV>>& p = space.curved_point;
    if constexpr (kClosedForm) {
      Array<kX> scaled;
      for (std::size_t r = 0; r < kX; ++r) scaled[r] = h * weight[r];
      ocp_.add_curvature(at_state(k, j), scaled.data(), block.data());
      cost_and_rows_at(k, j, v, p);
    } else {
      evaluate_at(k, j, v, p);
      for (std::size_t r = 0; r < kX; ++r) accumulate(h * weight[r], p.f[r]);
    }
    accumulate(cost_weight, p.cost);
    for (int c = 0; c < kC; ++c) {
      if (path_row(k, j, c) >= 0) accumulate(multipliers(path_row(k, j, c)), p.rows[index(c)]);
    }
  }

  Ocp ocp_;
  Scheme scheme_;
  Mesh mesh_;
  int stages_ = 0, first_new_ = 0, rows_ = 0, first_sum_row_ = 0;
  std::vector<int> interval_row_, path_rows_;
  std::vector<std::size_t> interval_jacobian_, interval_hessian_;  // first entry of each interval; last: of the rest
  Point<Pattern<kV>> structure_;
  std::vector<std::vector<std::pair<int, int>>> curved_at_nodes_;  // in the order of the cost nodes
  IntervalEntries<kX, kU, kC> entries_;
  mutable Eigen::VectorXd valued_at_, derived_at_;
  mutable std::vector<PointValues> values_;
  mutable std::vector<Point<Dual<kV>>> derived_;
  mutable std::array<WorkSpace, 2> work_spaces_;
  mutable std::vector<AtState> at_states_;  // in the order of the states, at the point of derived_
};

}  // namespace fjr
