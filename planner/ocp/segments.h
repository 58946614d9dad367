// The motion's segments: one before each via point, and one after the last.
#pragma once

#include <array>
#include <vector>

#include "planner/collocation/mesh.h"
#include "planner/collocation/transcription.h"
#include "planner/problem/problem.h"

namespace fjr {

inline std::size_t segment_count(const Problem& problem) { return problem.via.size() + 1; }

// Returns the bounds [s] on the duration of every segment; they are equal if via times fix it. The upper ones are those
// of ProblemVariation::longest, where it has any.
std::vector<std::array<double, 2>> segment_durations(const Problem& problem);

// Returns the bounds on sums of durations: one for every two prescribed times with several segments between them.
std::vector<DurationSum> duration_sums(const Problem& problem);

// Returns the index of the node at the end of a segment.
std::size_t end_node(const Mesh& mesh, std::size_t segment);

// Return the node of the mesh and the time [s] of the release: the end of the segment before the release via point, or
// of the motion if the request names none.
std::size_t release_node(const Problem& problem, const Mesh& mesh);
double release_time(const Problem& problem, const std::vector<double>& durations);

// Returns durations [s] of the segments that sum to `duration`, agree with the prescribed via times, and are otherwise
// proportional to `weights` (one per segment, positive).
std::vector<double> apportioned(const Problem& problem, double duration, const std::vector<double>& weights);

}  // namespace fjr
