#include "planner/ocp/segments.h"

#include <algorithm>
#include <numeric>

namespace fjr {
namespace {

// Returns the stretches of segments between two prescribed times (or up to the end), with the bounds on their
// durations.
std::vector<DurationSum> stretches(const Problem& problem) {
  std::vector<DurationSum> result;
  const int last = static_cast<int>(problem.via.size());
  int first = 0;
  double begin = 0;
  for (int s = 0; s < last; ++s) {
    const auto& time = problem.via[static_cast<std::size_t>(s)].time;
    if (!time) continue;
    result.push_back({first, s, *time - begin, *time - begin});
    first = s + 1;
    begin = *time;
  }
  result.push_back({first, last, problem.duration.min - begin, problem.duration.max - begin});
  return result;
}

}  // namespace

std::vector<std::array<double, 2>> segment_durations(const Problem& problem) {
  std::vector<std::array<double, 2>> bounds(segment_count(problem));
  for (const DurationSum& stretch : stretches(problem)) {
    for (int s = stretch.first; s <= stretch.last; ++s) {
      auto& b = bounds[static_cast<std::size_t>(s)];
      b = stretch.first == stretch.last ? std::array<double, 2>{stretch.lower, stretch.upper}
                                        : std::array<double, 2>{kShortestSegment, stretch.upper};
    }
  }
  for (std::size_t s = 0; s < problem.variation.longest.size(); ++s) {
    bounds[s][1] = std::clamp(problem.variation.longest[s], bounds[s][0], bounds[s][1]);
  }
  return bounds;
}

std::vector<DurationSum> duration_sums(const Problem& problem) {
  std::vector<DurationSum> sums = stretches(problem);
  std::erase_if(sums, [](const DurationSum& sum) { return sum.first == sum.last; });
  return sums;
}

std::size_t end_node(const Mesh& mesh, std::size_t segment) {
  const auto after = std::find_if(mesh.intervals.begin(), mesh.intervals.end(), [segment](const Mesh::Interval& i) {
    return static_cast<std::size_t>(i.segment) > segment;
  });
  return static_cast<std::size_t>(after - mesh.intervals.begin());
}

std::size_t release_node(const Problem& problem, const Mesh& mesh) {
  return end_node(mesh, problem.release.value_or(problem.via.size()));
}

double release_time(const Problem& problem, const std::vector<double>& durations) {
  const auto last = static_cast<std::ptrdiff_t>(problem.release.value_or(problem.via.size()));
  return std::accumulate(durations.begin(), durations.begin() + last + 1, 0.0);
}

std::vector<double> apportioned(const Problem& problem, double duration, const std::vector<double>& weights) {
  std::vector<double> durations = weights;
  for (const DurationSum& stretch : stretches(problem)) {
    const auto from = durations.begin() + stretch.first, to = durations.begin() + stretch.last + 1;
    const bool to_the_end = to == durations.end();
    const double length = to_the_end ? duration - (problem.duration.min - stretch.lower) : stretch.lower;
    const double sum = std::accumulate(from, to, 0.0);
    std::for_each(from, to, [=](double& d) { d *= length / sum; });
  }
  return durations;
}

}  // namespace fjr
