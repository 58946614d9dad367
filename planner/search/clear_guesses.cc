#include "planner/search/clear_guesses.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "planner/problem/task/task.h"
#include "planner/search/detours.h"

namespace fjr {
namespace {

// Returns a path by way of a posture, if there is one and it is a detour.
std::optional<Path> path_by(const DetourFinder& finder, std::size_t segment, const Joints<double>& from,
                            const Joints<double>& posture, const Joints<double>& to) {
  constexpr double kDetour = 1.05;  // times the straight way
  const double by_way_of_it = task::distance(from, posture) + task::distance(posture, to);
  if (by_way_of_it < kDetour * task::distance(from, to)) return std::nullopt;
  const std::vector<Path> there = finder.find(segment, from, posture, 1).paths;
  if (there.empty()) return std::nullopt;
  const std::vector<Path> onward = finder.find(segment, posture, to, 1).paths;
  if (onward.empty()) return std::nullopt;
  Path path = there.front();
  path.insert(path.end(), onward.front().begin() + 1, onward.front().end());
  return path;
}

}  // namespace

double clearance_from_obstacles(const Problem& problem, const Guess& guess) {
  constexpr int kPieces = 100;
  Task obstacles;
  obstacles.obstacles = problem.task.obstacles;
  const std::vector<TaskRow> rows = task_rows(problem.robot, obstacles, 0);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kPieces; ++i) {
    const auto posture = Posture<double>::of(problem.robot, guess.state(static_cast<double>(i) / kPieces).q);
    for (const TaskRow& row : rows) least = std::min(least, row.clearance(row.value(problem.robot, posture)));
  }
  return least;
}

bool keeps_clear(const Problem& problem, const Guess& guess) {
  constexpr double kPutRight = 0.01;  // [m]
  return clearance_from_obstacles(problem, guess) > -kPutRight;
}

std::vector<Guess> clear_guesses_by_postures(const Problem& problem, double duration, const std::vector<Path>& usual) {
  using OptionalPosture = std::optional<Joints<double>>;
  using Choice = std::function<OptionalPosture(const Joints<double>& from, const Joints<double>& to)>;
  const std::vector<std::pair<std::string, Choice>> postures{
      {"hanging", [&](const auto&, const auto&) { return hanging_posture(problem); }},
      {"joint 1 first",
       [](const auto& from, const auto& to) {
         return OptionalPosture{{to[0], from[1]}};
       }},
      {"joint 2 first", [](const auto& from, const auto& to) {
         return OptionalPosture{{from[0], to[1]}};
       }}};
  const DetourFinder finder(problem);
  std::vector<Guess> guesses;
  for (const auto& [name, posture] : postures) {
    std::vector<Path> paths = usual;
    bool any = false;
    for (std::size_t s = 0; s < paths.size(); ++s) {
      const Joints<double> from = usual[s].front(), to = usual[s].back();
      const OptionalPosture by = posture(from, to);
      if (std::optional<Path> other = by ? path_by(finder, s, from, *by, to) : std::nullopt) {
        paths[s] = std::move(*other);
        any = true;
      }
    }
    if (!any) continue;
    guesses.push_back(smooth_path_guess(problem, duration, paths));
    guesses.back().name += ", " + name;
  }
  return guesses;
}

Guess displaced_clear_guess(const Problem& problem, const Guess& guess, double size, std::uint64_t seed) {
  constexpr std::uint64_t kAttempts = 40;
  constexpr double kSmaller = 0.93;  // from one attempt to the next
  for (std::uint64_t i = 0; i < kAttempts; ++i, size *= kSmaller) {
    Guess displaced = displaced_guess(guess, size, seed * kAttempts + i);
    if (keeps_clear(problem, displaced)) return displaced;
  }
  return guess;
}

}  // namespace fjr
