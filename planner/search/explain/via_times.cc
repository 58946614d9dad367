#include "planner/search/explain/via_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "planner/search/fastest.h"

namespace fjr {
namespace {

std::string name_of(std::size_t i) { return fmt::format("via[{}].time", i); }

}  // namespace

std::optional<double> earliest_at(const Problem& problem, std::size_t i, Search& search) {
  auto earliest = sketch_to_via(problem, i, search);
  if (!earliest || earliest->follow_homotopy() != Completion::kFinished) return std::nullopt;
  return earliest->solution().motion.duration();
}

NearestTime nearest_time(const Problem& problem, std::size_t i, std::optional<double> least, Search& search) {
  Problem moved = problem;
  moved.weights = {.time = 1};
  if (least) {
    moved.via[i].time = least;
    if (search.sketch(moved, name_of(i), search.guesses(moved))) return {least, {}};
  }
  moved.via[i].time.reset();
  auto possible = search.sketch(moved, name_of(i), search.guesses(moved));
  if (!possible) return {};
  const auto& durations = possible->solution().durations;
  const double asked = *problem.via[i].time;
  double wrong = asked;
  double right = std::accumulate(durations.begin(), durations.begin() + static_cast<std::ptrdiff_t>(i) + 1, 0.0);
  const double least_change = search.settings().no_change * asked;
  const double tolerance = search.settings().time_tolerance;
  while (std::abs(right - wrong) > std::max(tolerance * std::abs(right - asked), least_change) && !search.over()) {
    moved.via[i].time = (wrong + right) / 2;
    auto next = search.sketch(moved, name_of(i), {guess_of(*possible)});
    (next ? right : wrong) = *moved.via[i].time;
    if (next) possible = std::move(next);
  }
  if (wrong != asked || search.over()) return {right, {}};
  // Every time that was tried is feasible, so the requested one may be too, from the last motion.
  moved.via[i].time = asked;
  if (const auto kept = search.sketch(moved, name_of(i), {guess_of(*possible)})) return {right, guess_of(*kept)};
  return {right, {}};
}

}  // namespace fjr
