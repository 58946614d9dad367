// The mesh: how a motion is divided into segments and collocation intervals.
#pragma once

#include <cstddef>
#include <vector>

namespace fjr {

// The motion is a chain of segments, each with a duration of its own (an optimisation variable, fixed or bounded), and
// each divided into intervals by fixed fractions of it. One segment is the ordinary case; a boundary between segments
// is a node whose time the optimiser may move.
struct Mesh {
  struct Interval {
    double fraction;  // of its segment's duration; the fractions of a segment sum to 1
    int segment;      // non-decreasing along the chain, from 0
    bool operator==(const Interval&) const = default;
  };
  std::vector<Interval> intervals;

  bool operator==(const Mesh&) const = default;

  int segments() const { return intervals.empty() ? 0 : intervals.back().segment + 1; }
  std::size_t size() const { return intervals.size(); }

  // Returns the times [s] of the size() + 1 nodes, given the durations [s] of the segments.
  std::vector<double> node_times(const std::vector<double>& durations) const {
    std::vector<double> times{0};
    double start = 0, inside = 0;
    for (std::size_t k = 0; k < intervals.size(); ++k) {
      const double duration = durations[static_cast<std::size_t>(intervals[k].segment)];
      inside += intervals[k].fraction;
      const bool last = k + 1 == intervals.size() || intervals[k + 1].segment != intervals[k].segment;
      if (last) {
        start += duration;
        inside = 0;
        times.push_back(start);
      } else {
        times.push_back(start + inside * duration);
      }
    }
    return times;
  }
};

}  // namespace fjr
