// The motion's segments: one before each via point, and one after the last.
#pragma once

#include <array>
#include <vector>

#include "planner/collocation/mesh.h"
#include "planner/collocation/transcription.h"
#include "planner/problem/problem.h"

namespace fjr {

inline std::size_t segment_count(const Problem& problem) { return problem.via.size() + 1; }

// Bounds [s] on the duration of every segment; equal where via times fix it.
std::vector<std::array<double, 2>> segment_durations(const Problem& problem);

// Between moments that are given lie one or more segments; where several, their sum is bounded.
std::vector<DurationSum> duration_sums(const Problem& problem);

// The node at the end of a segment.
std::size_t end_node(const Mesh& mesh, std::size_t segment);

// Where what is thrown is let go: at that node of the mesh, after that time [s].
std::size_t release_node(const Problem& problem, const Mesh& mesh);
double release_time(const Problem& problem, const std::vector<double>& durations);

// Durations [s] of the segments that sum to `duration`, meet the via times that are given, and are otherwise in
// proportion to `weights` (one per segment, positive).
std::vector<double> apportioned(const Problem& problem, double duration, const std::vector<double>& weights);

}  // namespace fjr
