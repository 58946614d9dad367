// Optimal control problems from the literature with their published optima, for tests and benchmarks: the same
// transcription, linear solver and optimiser as the arm's.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "planner/collocation/transcription.h"
#include "planner/nlp/solve.h"
#include "tests/support/plants.h"

namespace fjr {

// R. Luus, Iterative Dynamic Programming, CRC Press 2000, section 12.4.2: a two-link arm in the horizontal plane.
// x: angular velocities of the links, angle between them, angle of the first; u: torques.
struct TwoLinkArm : OcpData<4, 2, 0> {
  static constexpr std::array<bool, kRows> kRowUsesControl{};

  template <class T>
  void evaluate(const T* x, const T* u, T* f, T& cost, T*) const {
    using std::cos, std::sin;
    const T s = sin(x[2]), c = cos(x[2]), inertia = 31.0 / 36 + 2.25 * s * s;
    f[0] = (s * (2.25 * c * x[0] * x[0] + 2.0 * x[1] * x[1]) + 4.0 / 3 * (u[0] - u[1]) - 1.5 * c * u[1]) / inertia;
    f[1] =
        -1.0 * (s * (3.5 * x[0] * x[0] + 2.25 * c * x[1] * x[1]) - 7.0 / 3 * u[1] + 1.5 * c * (u[0] - u[1])) / inertia;
    f[2] = x[1] - x[0];
    f[3] = x[0];
    cost = T(0.0);
  }
};

// J. T. Betts, Practical Methods for Optimal Control Using Nonlinear Programming, 3rd ed., SIAM 2020, problem 10.74
// and section 5.6: a thrust of constant size steered by its angle. x: position, velocity.
struct TangentSteering : OcpData<4, 1, 0> {
  static constexpr std::array<bool, kRows> kRowUsesControl{};
  static constexpr double kThrust = 100;

  template <class T>
  void evaluate(const T* x, const T* u, T* f, T& cost, T*) const {
    using std::cos, std::sin;
    f[0] = x[2];
    f[1] = x[3];
    f[2] = kThrust * cos(u[0]);
    f[3] = kThrust * sin(u[0]);
    cost = T(0.0);
  }
};

// Betts, problem 10.113; H. Maurer & D. Augustin, in Online Optimization of Large Scale Systems, Springer 2001: an
// electric circuit (Rayleigh) with a constraint on state and control together. Row: u + x1 / 6 <= 0.
struct Rayleigh : OcpData<2, 1, 1> {
  static constexpr std::array<bool, kRows> kRowUsesControl{true};

  template <class T>
  void evaluate(const T* x, const T* u, T* f, T& cost, T* rows) const {
    f[0] = x[1];
    f[1] = x[1] * (1.4 - 0.14 * x[1] * x[1]) - x[0] + 4.0 * u[0];
    cost = u[0] * u[0] + x[0] * x[0];
    rows[0] = u[0] + x[0] / 6.0;
  }
};

// A problem on a mesh, and where to start.
struct Posed {
  std::unique_ptr<Nlp> nlp;
  Iterate start;
};

struct PublishedProblem {
  std::string name, source;
  double reference;                                         // published optimum
  std::function<Posed(const Scheme&, int intervals)> pose;  // on equal intervals
};

// States on the straight line from `from` to `to`, controls zero, segments of equal duration.
template <class Ocp>
Posed pose_straight(Ocp ocp, const Scheme& scheme, const Mesh& mesh, const Array<Ocp::kStates>& from,
                    const Array<Ocp::kStates>& to, double duration) {
  auto nlp = std::make_unique<Transcription<Ocp>>(std::move(ocp), scheme, mesh);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(nlp->variables());
  const int segments = mesh.segments();
  const std::vector<double> shares = mesh.node_times(std::vector<double>(static_cast<std::size_t>(segments), 1.0));
  const auto put = [&](int at, double share) {
    for (int i = 0; i < Ocp::kStates; ++i) {
      const auto r = static_cast<std::size_t>(i);
      z(at + i) = from[r] + share / segments * (to[r] - from[r]);
    }
  };
  put(nlp->node_at(0), 0);
  for (int k = 0; k < nlp->intervals(); ++k) {
    const double begin = shares[static_cast<std::size_t>(k)], end = shares[static_cast<std::size_t>(k) + 1];
    for (int j = 0; j < scheme.stages(); ++j) put(nlp->x_at(k, j), begin + scheme.points(j) * (end - begin));
  }
  for (int s = 0; s < segments; ++s) z(nlp->duration_at(s)) = duration / segments;
  return {std::move(nlp), {z, {}, {}, {}}};
}

// Fixed at both ends, apart from what is infinite in `to`.
template <class Ocp>
void fix_ends(Ocp& ocp, const Mesh& mesh, const Array<Ocp::kStates>& from, const Array<Ocp::kStates>& to) {
  NodeBounds<Ocp::kStates> end{mesh.size(), to, to};
  for (std::size_t i = 0; i < to.size(); ++i) {
    if (std::isinf(to[i])) end.lower[i] = -to[i];
  }
  ocp.at_nodes = {{0, from, from}, end};
}

inline Posed minimum_time_double_integrator(const Scheme& scheme, int intervals) {
  const Mesh mesh = equal_intervals(intervals);
  DoubleIntegrator ocp;
  ocp.time_weight = 1;
  ocp.bounds[0].u_lower = {-1};
  ocp.bounds[0].u_upper = {1};
  ocp.durations = {{0.1, 10}};
  fix_ends(ocp, mesh, {0, 0}, {1, 0});
  return pose_straight(std::move(ocp), scheme, mesh, {0, 0}, {1, 0}, 3);
}

inline Posed minimum_time_two_link_arm(TwoLinkArm ocp, const Scheme& scheme, const Mesh& mesh) {
  constexpr Array<4> kFrom{0, 0, 0.5, 0}, kTo{0, 0, 0.5, 0.522};
  ocp.time_weight = 1;
  ocp.durations.assign(static_cast<std::size_t>(mesh.segments()), {0.01, 10});
  fix_ends(ocp, mesh, kFrom, kTo);
  return pose_straight(std::move(ocp), scheme, mesh, kFrom, kTo, 3);
}

inline Posed minimum_time_two_link_arm(const Scheme& scheme, int intervals) {
  TwoLinkArm ocp;
  ocp.bounds[0].u_lower = {-1, -1};
  ocp.bounds[0].u_upper = {1, 1};
  return minimum_time_two_link_arm(std::move(ocp), scheme, equal_intervals(intervals));
}

// The same with the optimum's switches as nodes, `intervals` on each of the four arcs, whose durations are free; on an
// arc no control changes its sign.
inline Posed minimum_time_two_link_arm_by_arcs(const Scheme& scheme, int intervals) {
  constexpr std::array<Array<2>, 4> kSigns{{{1, 1}, {1, -1}, {-1, -1}, {-1, 1}}};
  TwoLinkArm ocp;
  ocp.bounds.clear();
  Mesh mesh;
  for (int arc = 0; arc < 4; ++arc) {
    PathBounds<4, 2, 0> bounds;
    for (std::size_t i = 0; i < 2; ++i) {
      const double sign = kSigns[static_cast<std::size_t>(arc)][i];
      bounds.u_lower[i] = std::min(0.0, sign);
      bounds.u_upper[i] = std::max(0.0, sign);
    }
    for (int k = 0; k < intervals; ++k) {
      mesh.intervals.push_back({1.0 / intervals, arc});
      ocp.bounds.push_back(bounds);
    }
  }
  return minimum_time_two_link_arm(std::move(ocp), scheme, mesh);
}

inline Posed tangent_steering(const Scheme& scheme, int intervals) {
  const double any = std::numeric_limits<double>::infinity();
  const Mesh mesh = equal_intervals(intervals);
  TangentSteering ocp;
  ocp.time_weight = 1;
  ocp.bounds[0].u_lower = {-std::numbers::pi / 2};
  ocp.bounds[0].u_upper = {std::numbers::pi / 2};
  ocp.durations = {{0.1, 10}};
  fix_ends(ocp, mesh, {0, 0, 0, 0}, {any, 5, 45, 0});
  return pose_straight(std::move(ocp), scheme, mesh, {0, 0, 0, 0}, {12, 5, 45, 0}, 1);
}

inline Posed rayleigh(const Scheme& scheme, int intervals) {
  const double any = std::numeric_limits<double>::infinity();
  const Mesh mesh = equal_intervals(intervals);
  Rayleigh ocp;
  ocp.bounds[0].row_upper = {0};
  ocp.durations = {{4.5, 4.5}};
  fix_ends(ocp, mesh, {-5, -5}, {any, any});
  return pose_straight(std::move(ocp), scheme, mesh, {-5, -5}, {0, 0}, 4.5);
}

// With the velocity bounded from below.
inline Posed van_der_pol(const Scheme& scheme, int intervals) {
  const double any = std::numeric_limits<double>::infinity();
  const Mesh mesh = equal_intervals(intervals);
  VanDerPol ocp;
  ocp.bounds[0].x_lower = {-0.4, -any};
  ocp.durations = {{5, 5}};
  fix_ends(ocp, mesh, {0, 1}, {any, any});
  return pose_straight(std::move(ocp), scheme, mesh, {0, 1}, {0, 0}, 5);
}

inline std::vector<PublishedProblem> published_problems() {
  return {
      {"double integrator, minimum time", "closed form", 2, minimum_time_double_integrator},
      {"two-link arm, minimum time", "Luus 2000, 12.4.2", 2.983,
       [](const Scheme& scheme, int intervals) { return minimum_time_two_link_arm(scheme, intervals); }},
      {"linear tangent steering", "Betts 2020, 10.74", 0.554570879, tangent_steering},
      {"Rayleigh, mixed constraint", "Betts 2020, 10.113", 44.8044433, rayleigh},
      {"van der Pol, state bound", "Betts 2020, 10.144", 2.95369916, van_der_pol},
  };
}

}  // namespace fjr
