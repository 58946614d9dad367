// What the members of an Ocp are made of (transcription.h): bounds, costs of single points, closed forms at a state;
// and the inputs that it is evaluated with.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace fjr {

template <int N>
using Array = std::array<double, static_cast<std::size_t>(N)>;

// Bounds on the state at one node of the mesh, in addition to the general ones; equal where fixed.
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

// Bounds that hold along the way; +-infinity where there is none.
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

// Bounds on a path row that does not see the control, at one node other than the first.
struct RowBounds {
  std::size_t node;
  int row;
  double lower, upper;
};

// A running cost at one collocation point: value + slope (v - near) + 1/2 curvature (v - near)^2, of its states and
// controls v.
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

// Whether an Ocp has closed forms of what depends on the state alone, and what they are kept in.
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

// The inputs of a function whose derivatives are asked for at one point after the other. To make them anew for every
// point took a sixth of the time of a Hessian.
template <class D>
class Inputs {
 public:
  Inputs() {
    for (int i = 0; i < D::kInputs; ++i) v_[static_cast<std::size_t>(i)] = D::input(0, i);
  }
  // D::kInputs numbers, valid until the next point.
  const D* at(const Array<D::kInputs>& values) {
    for (std::size_t i = 0; i < v_.size(); ++i) v_[i].v = values[i];
    return v_.data();
  }

 private:
  std::array<D, static_cast<std::size_t>(D::kInputs)> v_;
};

}  // namespace fjr
