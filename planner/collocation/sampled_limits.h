// Computes the part of d objective / d (time of a node) that arises because limits are imposed at collocation points
// only.
//
// When a node moves in time, the collocation points beside it move along. Let the limited quantity g change at the rate
// dg/dt at a point whose limit has the multiplier mu. If the motion stays the same in time, then moving the point by 1
// s changes the Lagrangian by mu dg/dt. This contribution says nothing about the motion itself, because the limit is
// meant to hold between the points as well; so it is separated from the rest.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "planner/collocation/transcription.h"
#include "planner/nlp/solve.h"

namespace fjr {

// Contribution of the limits to d objective / d (time of a node). Where the controls jump at the node, the rates jump
// as well, and the contribution lies between the values for the rates `before` and `after` the node.
struct SampledLimits {
  double before = 0, after = 0;

  // Returns the part of `slope` = d objective / d (time of the node) that the limits cannot explain: its signed
  // distance from the interval spanned by 0, `before` and `after`. (0 belongs to it because the mesh refinement moves
  // nodes to where the contributions of the motion and of the limits cancel.)
  double left_of(double slope) const {
    return slope - std::clamp(slope, std::min({before, after, 0.0}), std::max({before, after, 0.0}));
  }
  void add(double both) { before += both, after += both; }
};

namespace sampled_limits_detail {

template <class Ocp>
class Sampling {
 public:
  Sampling(const Transcription<Ocp>& t, const Iterate& solution)
      : t_(t),
        solution_(solution),
        points_(t.first_derivatives(solution.x)),
        nodes_(static_cast<std::size_t>(t.intervals()) + 1) {}

  std::vector<SampledLimits> run() && {
    const int last = t_.scheme().stages() - 1;
    for (int k = 0; k < t_.intervals(); ++k) {
      for (int i = 0; i < kU; ++i) {
        for (int end = 0; end < 2; ++end) node(k + end).add(multiplier(t_.u_at(k, end) + i) * control_rate(k, i));
      }
      for (int j = 0; j <= last; ++j) {
        const Rates rates = t_.values(solution_.x, k, j).f;
        const bool at_start = j == 0 && t_.scheme().starts_at_node;
        const double by_state = at_start || j == last ? 0 : of_state(k, j, rates);
        const double change = of_control(k, j, rates) + by_state, fraction = t_.scheme().points(j);
        node(k).add((1 - fraction) * change);
        node(k + 1).add(fraction * change);
      }
      node(k + 1).before += of_state(k, last, t_.values(solution_.x, k, last).f);
      const bool same = k + 1 == t_.intervals() || !t_.scheme().starts_at_node;
      node(k + 1).after +=
          of_state(k, last, same ? t_.values(solution_.x, k, last).f : t_.values(solution_.x, k + 1, 0).f);
    }
    return std::move(nodes_);
  }

 private:
  static constexpr int kX = Transcription<Ocp>::kX, kU = Transcription<Ocp>::kU, kC = Transcription<Ocp>::kC;
  using Rates = std::array<double, static_cast<std::size_t>(kX)>;  // dx/dt

  SampledLimits& node(int k) { return nodes_[static_cast<std::size_t>(k)]; }
  // Returns the multiplier of the bounds on a variable, upper minus lower; 0 if the solution has none.
  double multiplier(int at) const {
    return solution_.z_upper.size() == 0 ? 0 : solution_.z_upper(at) - solution_.z_lower(at);
  }
  double control_rate(int k, int i) const {
    return (solution_.x(t_.u_at(k, 1) + i) - solution_.x(t_.u_at(k, 0) + i)) / t_.step(solution_.x, k);
  }

  // Returns the sum of multiplier times rate over the bounds on states and the path constraints without control.
  double of_state(int k, int j, const Rates& rates) const {
    double sum = 0;
    for (int i = 0; i < kX; ++i) sum += multiplier(t_.x_at(k, j) + i) * rates[static_cast<std::size_t>(i)];
    return sum + of_rows(k, j, rates, false);
  }
  double of_control(int k, int j, const Rates& rates) const { return of_rows(k, j, rates, true); }

  double of_rows(int k, int j, const Rates& rates, bool with_control) const {
    double sum = 0;
    const auto& rows = points_[static_cast<std::size_t>(k * t_.scheme().stages() + j)].rows;
    for (int c = 0; c < kC; ++c) {
      const int row = t_.path_row(k, j, c);
      if (row < 0 || Ocp::kRowUsesControl[static_cast<std::size_t>(c)] != with_control) continue;
      const auto& slope = rows[static_cast<std::size_t>(c)].g;
      double rate = 0;
      for (int i = 0; i < kX; ++i) rate += slope[static_cast<std::size_t>(i)] * rates[static_cast<std::size_t>(i)];
      for (int i = 0; i < kU; ++i) rate += slope[static_cast<std::size_t>(kX + i)] * control_rate(k, i);
      sum += solution_.lambda(row) * rate;
    }
    return sum;
  }

  const Transcription<Ocp>& t_;
  const Iterate& solution_;
  const typename Transcription<Ocp>::Derivatives& points_;
  std::vector<SampledLimits> nodes_;
};

}  // namespace sampled_limits_detail

// Returns one element per node of the mesh.
template <class Ocp>
std::vector<SampledLimits> sampled_limits(const Transcription<Ocp>& t, const Iterate& solution) {
  return sampled_limits_detail::Sampling<Ocp>(t, solution).run();
}

}  // namespace fjr
