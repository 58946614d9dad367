// Types of the members of an Ocp (transcription.h): bounds, costs at single collocation points and closed-form
// derivatives; and the storage for the inputs it is evaluated with.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace fjr {

template <int N>
using Array = std::array<double, static_cast<std::size_t>(N)>;

// Bounds on the state at one node of the mesh, in addition to the path bounds. A fixed state has lower = upper.
template <int N>
struct NodeBounds {
  std::size_t node;
  Array<N> lower, upper;
};

template <int N>
Array<N> filled(double value) {
  Array<N> a;
  a.fill(value);
  return a;
}

// Bounds on states, controls and path constraints along the motion; +-infinity means no bound.
template <int kX, int kU, int kC>
struct PathBounds {
  Array<kX> x_lower = filled<kX>(-std::numeric_limits<double>::infinity());
  Array<kX> x_upper = filled<kX>(std::numeric_limits<double>::infinity());
  Array<kU> u_lower = filled<kU>(-std::numeric_limits<double>::infinity());
  Array<kU> u_upper = filled<kU>(std::numeric_limits<double>::infinity());
  Array<kC> row_lower = filled<kC>(-std::numeric_limits<double>::infinity());
  Array<kC> row_upper = filled<kC>(std::numeric_limits<double>::infinity());
};

// Bounds [s] on the sum of the durations of segments first to last.
struct DurationSum {
  int first, last;
  double lower, upper;
};

// Bounds on a path constraint at a single node, which is not the first. The constraint must not depend on the control.
struct RowBounds {
  std::size_t node;
  int row;
  double lower, upper;
};

// Quadratic running cost at one collocation point with states and controls v, summed over their components: value +
// slope (v - near) + 1/2 curvature (v - near)^2.
template <int kV>
struct PointCost {
  double value = 0;
  Array<kV> near{}, slope{}, curvature{};

  template <class T>
  T of(const T* v) const {
    T cost(value);
    for (std::size_t i = 0; i < kV; ++i) {
      if (slope[i] == 0 && curvature[i] == 0) continue;
      const T away = v[i] - near[i];
      cost += slope[i] * away + 0.5 * curvature[i] * (away * away);
    }
    return cost;
  }
};

// An Ocp may compute results that depend on the state alone once, for derivatives in closed form (transcription.h).
// AtStateOf is the type of these results, an empty struct if the Ocp has none.
template <class Ocp>
concept HasClosedForm = requires(const Ocp& ocp, const double* x) {
  ocp.at_state(x);
};
struct NoClosedForm {};
template <class Ocp>
struct ClosedForm : std::type_identity<NoClosedForm> {};
template <HasClosedForm Ocp>
struct ClosedForm<Ocp> : std::type_identity<typename Ocp::AtState> {};
template <class Ocp>
using AtStateOf = typename ClosedForm<Ocp>::type;

// Reusable inputs of a differentiated function: only the values change from point to point, the seeds stay.
// Constructing the inputs anew at every point took a sixth of the time of a Hessian.
template <class D>
class Inputs {
 public:
  Inputs() {
    for (int i = 0; i < D::kInputs; ++i) v_[static_cast<std::size_t>(i)] = D::input(0, i);
  }
  // Returns D::kInputs numbers, valid until the next call.
  const D* at(const Array<D::kInputs>& values) {
    for (std::size_t i = 0; i < v_.size(); ++i) v_[i].v = values[i];
    return v_.data();
  }

 private:
  std::array<D, static_cast<std::size_t>(D::kInputs)> v_;
};

}  // namespace fjr
