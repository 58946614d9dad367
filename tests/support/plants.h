// Small optimal control problems with known answers, and how the tests set them up.
#pragma once

#include <array>
#include <ostream>
#include <string>
#include <vector>

#include "planner/collocation/scheme.h"
#include "planner/collocation/transcription.h"

namespace fjr {

inline Mesh equal_intervals(int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) mesh.intervals.push_back({1.0 / count, 0});
  return mesh;
}

// What every plant of these problems has; bounds hold on all intervals.
template <int kX, int kU, int kC>
struct OcpData {
  static constexpr int kStates = kX, kControls = kU, kRows = kC;
  double time_weight = 0;
  std::vector<PathBounds<kX, kU, kC>> bounds = std::vector<PathBounds<kX, kU, kC>>(1);
  std::vector<NodeBounds<kX>> at_nodes;
  std::vector<std::array<double, 2>> durations;
  std::vector<DurationSum> duration_sums;
};

// x'' = u. cost = time_weight T + effort int u^2 dt.  Row: the position, for limits on the way.
struct DoubleIntegrator : OcpData<2, 1, 1> {
  static constexpr std::array<bool, kRows> kRowUsesControl{false};
  double effort = 0;

  template <class T>
  void evaluate(const T* x, const T* u, T* f, T& cost, T* rows) const {
    f[0] = x[1];
    f[1] = u[0];
    cost = effort * (u[0] * u[0]);
    rows[0] = x[0];
  }
};

// From (x, v) to (x, v) on `intervals` equal intervals.
inline DoubleIntegrator double_integrator(const Array<2>& from, const Array<2>& to, int intervals) {
  DoubleIntegrator ocp;
  ocp.at_nodes = {{0, from, from}, {static_cast<std::size_t>(intervals), to, to}};
  return ocp;
}

// x1' = (1 - x2^2) x1 - x2 + u, x2' = x1; cost = int x1^2 + x2^2 + u^2 dt + time_weight T.
// Rows: one that sees the control, one that does not, one that nobody asks for.
struct VanDerPol : OcpData<2, 1, 3> {
  static constexpr std::array<bool, kRows> kRowUsesControl{true, false, true};

  template <class T>
  void evaluate(const T* x, const T* u, T* f, T& cost, T* rows) const {
    using std::sin;
    f[0] = (1.0 - x[1] * x[1]) * x[0] - x[1] + u[0];
    f[1] = x[0];
    cost = x[0] * x[0] + x[1] * x[1] + u[0] * u[0];
    rows[0] = u[0] * x[0] + sin(u[0]);
    rows[1] = x[0] + 0.1 * x[1] * x[1];
    rows[2] = x[1] * u[0];
  }
};

// Names of parameterised tests, as test names and in messages.
inline std::ostream& operator<<(std::ostream& out, const Scheme& scheme) { return out << scheme.name; }
inline std::string identifier(std::string name) {
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}

}  // namespace fjr
