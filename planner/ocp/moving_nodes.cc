#include "planner/ocp/moving_nodes.h"

#include <algorithm>
#include <array>
#include <utility>

#include "planner/collocation/adjoint.h"
#include "planner/ocp/arm_collocation.h"

namespace fjr {
namespace {

constexpr double kMostStretched =
    2;  // factor by which a piece may become longer or shorter; the discretisation error grows with it

// The segments of the motion, divided into pieces at the nodes that move.
struct Pieces {
  Mesh mesh;                      // its segments are the pieces
  std::vector<int> segment;       // the segment that each piece belongs to
  std::vector<double> durations;  // [s]

  // Returns the first piece of a segment; for the segment after the last, the number of pieces.
  int first(int of_segment) const {
    return static_cast<int>(std::lower_bound(segment.begin(), segment.end(), of_segment) - segment.begin());
  }
  bool in_several(int of_segment) const { return first(of_segment + 1) - first(of_segment) > 1; }
};

Pieces cut(const Mesh& mesh, const std::vector<double>& durations, const std::vector<std::size_t>& nodes) {
  Pieces pieces;
  for (std::size_t k = 0; k < mesh.size(); ++k) {
    const auto& interval = mesh.intervals[k];
    const bool moving = std::binary_search(nodes.begin(), nodes.end(), k);
    if (moving || pieces.segment.empty() || pieces.segment.back() != interval.segment) {
      pieces.segment.push_back(interval.segment);
      pieces.durations.push_back(0);
    }
    const double duration = interval.fraction * durations[static_cast<std::size_t>(interval.segment)];
    pieces.durations.back() += duration;
    pieces.mesh.intervals.push_back({duration, static_cast<int>(pieces.segment.size()) - 1});
  }
  for (auto& interval : pieces.mesh.intervals) {
    interval.fraction /= pieces.durations[static_cast<std::size_t>(interval.segment)];
  }
  return pieces;
}

// Returns the durations of the segments [s], given those of the pieces.
std::vector<double> segment_durations_of(const Pieces& pieces, const std::vector<double>& durations) {
  std::vector<double> segments(static_cast<std::size_t>(pieces.segment.back()) + 1, 0.0);
  for (std::size_t p = 0; p < durations.size(); ++p)
    segments[static_cast<std::size_t>(pieces.segment[p])] += durations[p];
  return segments;
}

// Returns the mesh with the segments of the motion again, for these durations [s] of the pieces.
Mesh joined(const Pieces& pieces, const std::vector<double>& durations) {
  const std::vector<double> segments = segment_durations_of(pieces, durations);
  Mesh mesh;
  for (const auto& interval : pieces.mesh.intervals) {
    const auto piece = static_cast<std::size_t>(interval.segment);
    const int segment = pieces.segment[piece];
    mesh.intervals.push_back(
        {interval.fraction * durations[piece] / segments[static_cast<std::size_t>(segment)], segment});
  }
  return mesh;
}

// Returns the bounds on sums of segments as bounds on sums of pieces, followed by the bounds on every segment that
// consists of several pieces.
std::vector<DurationSum> sums_of(const Pieces& pieces, const std::vector<DurationSum>& sums_of_segments,
                                 const std::vector<std::array<double, 2>>& bounds_of_segments) {
  std::vector<DurationSum> sums;
  for (const DurationSum& sum : sums_of_segments) {
    sums.push_back({pieces.first(sum.first), pieces.first(sum.last + 1) - 1, sum.lower, sum.upper});
  }
  for (std::size_t i = 0; i < bounds_of_segments.size(); ++i) {
    const int segment = static_cast<int>(i);
    const auto& [lower, upper] = bounds_of_segments[i];
    if (pieces.in_several(segment))
      sums.push_back({pieces.first(segment), pieces.first(segment + 1) - 1, lower, upper});
  }
  return sums;
}

template <Features F>
using ArmTranscription = Transcription<ArmOcp<F>>;

// Returns the transcription whose mesh segments are the pieces instead.
template <Features F>
ArmTranscription<F> with_pieces(const ArmTranscription<F>& fixed, const Pieces& pieces) {
  ArmOcp<F> ocp = fixed.ocp();
  const auto tasks = std::exchange(ocp.tasks, {});
  const auto bounds = std::exchange(ocp.durations, {});
  for (std::size_t p = 0; p < pieces.segment.size(); ++p) {
    const auto segment = static_cast<std::size_t>(pieces.segment[p]);
    const double duration = pieces.durations[p];
    ocp.tasks.push_back(tasks[segment]);
    ocp.durations.push_back(pieces.in_several(pieces.segment[p])
                                ? std::array<double, 2>{duration / kMostStretched, duration * kMostStretched}
                                : bounds[segment]);
  }
  ocp.duration_sums = sums_of(pieces, ocp.duration_sums, bounds);
  return {std::move(ocp), fixed.scheme(), pieces.mesh};
}

// Converts iterates between the two transcriptions. These have the same variables except for the durations, and the
// same constraints except for the additional sums of durations at the end.
template <Features F>
struct Exchange {
  const ArmTranscription<F>& fixed;
  const ArmTranscription<F>& moving;
  const Pieces& pieces;

  Iterate to_moving(const Iterate& from, const Eigen::VectorXd& lagrangian) const {
    Iterate to = resized(from, moving);
    for (std::size_t p = 0; p < pieces.durations.size(); ++p) {
      to.x(moving.duration_at(static_cast<int>(p))) = pieces.durations[p];
    }
    // The bounds on a segment become a constraint on the sum of its pieces, with the multiplier that makes the
    // derivative of the Lagrangian by the segment's duration zero.
    each_new_sum([&](int segment, int row) { to.lambda(row) = -lagrangian(fixed.duration_at(segment)); });
    return to;
  }

  Iterate to_fixed(const Iterate& from, const std::vector<double>& segments) const {
    Iterate to = resized(from, fixed);
    for (std::size_t segment = 0; segment < segments.size(); ++segment)
      to.x(fixed.duration_at(static_cast<int>(segment))) = segments[segment];
    each_new_sum([&](int segment, int row) {
      to.z_upper(fixed.duration_at(segment)) = std::max(from.lambda(row), 0.0);
      to.z_lower(fixed.duration_at(segment)) = std::max(-from.lambda(row), 0.0);
    });
    return to;
  }

 private:
  Iterate resized(const Iterate& from, const ArmTranscription<F>& to) const {
    const auto head = [](const Eigen::VectorXd& v, Eigen::Index kept, Eigen::Index size) {
      Eigen::VectorXd result = Eigen::VectorXd::Zero(size);
      result.head(kept) = v.head(kept);
      return result;
    };
    const Eigen::Index states = fixed.duration_at(0), rows = fixed.sum_row(fixed.ocp().duration_sums.size());
    return {head(from.x, states, to.variables()), head(from.lambda, rows, to.constraints()),
            head(from.z_lower, states, to.variables()), head(from.z_upper, states, to.variables())};
  }

  // Calls visit(segment, row of the sum of its pieces) for every segment that consists of several pieces.
  template <class Visit>
  void each_new_sum(Visit&& visit) const {
    for (std::size_t i = fixed.ocp().duration_sums.size(); i < moving.ocp().duration_sums.size(); ++i) {
      const auto first = static_cast<std::size_t>(moving.ocp().duration_sums[i].first);
      visit(pieces.segment[first], moving.sum_row(i));
    }
  }
};

template <Features F>
Collocated move(const Problem& problem, const Collocated& start, const std::vector<std::size_t>& nodes,
                const SolveOptions& options) {
  namespace parts = arm_collocation;
  const auto fixed = parts::transcribe<F>(problem, start.setup);
  const Iterate& from = start.report.iterate;
  if (!parts::fits(fixed, from)) return {start.setup, {}, {}, {}};
  const Pieces pieces = cut(start.setup.mesh, start.durations, nodes);
  auto moving = with_pieces<F>(fixed, pieces);
  const Exchange<F> exchange{fixed, moving, pieces};
  Collocated result =
      parts::run(start.setup, moving, exchange.to_moving(from, adjoint(fixed, from).lagrangian), options);
  if (result.report.iterate.x.size() != moving.variables()) return result;
  result.setup.mesh = joined(pieces, result.durations);
  result.durations = segment_durations_of(pieces, result.durations);
  result.report.iterate = exchange.to_fixed(result.report.iterate, result.durations);
  return result;
}

}  // namespace

Collocated move_nodes(const Problem& problem, const Collocated& start, const std::vector<std::size_t>& nodes,
                      const SolveOptions& options) {
  return with_features(problem, [&]<Features F>() { return move<F>(problem, start, nodes, options); });
}

}  // namespace fjr
