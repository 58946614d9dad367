#include "planner/search/explain/search.h"

#include <algorithm>

namespace fjr {
namespace {

constexpr double kUsual = 1;         // [s] motions that take longer are begun with as many intervals as one of this
constexpr std::size_t kGuesses = 2;  // of the usual ones
constexpr int kPatience = 450;       // iterations of one start

}  // namespace

Guess guess_of(const Continuation& solution) {
  const Collocated& s = solution.solution();
  return guess_from(s.motion, s.durations, s.motion.duration());
}

std::vector<Guess> Search::guesses(const Problem& problem) const {
  std::vector<Guess> all = tools_.guesses(problem);
  if (all.size() > kGuesses) all.erase(all.begin() + kGuesses, all.end());
  return all;
}

void Search::book(const Continuation& c) {
  tools_.book(c);
  for (const SolverStage& stage : c.stages()) spent_ += stage.work;
}

std::optional<Continuation> Search::solve(const Problem& problem, const std::string& what,
                                          const std::vector<Guess>& guesses, bool exact) {
  const Problem& kept = problems_.emplace_back(problem);
  last_sketch_.reset();
  for (const Guess& guess : guesses) {
    if (over()) break;
    Continuation c = tools_.continuation(kept, "why not: " + what);
    if (kept.task.obstacles.empty()) c.mesh_factor = std::min(1.0, kUsual / guess.duration());
    const bool sketched = c.begin(guess, kPatience), solved = sketched && (!exact || c.follow_levels());
    book(c);
    if (solved) return c;
    if (sketched) last_sketch_ = std::move(c);
  }
  return std::nullopt;
}

std::optional<Continuation> Search::solve(const Problem& problem, const std::string& what,
                                          const std::vector<Guess>& guesses) {
  return solve(problem, what, guesses, true);
}

std::optional<Continuation> Search::sketch(const Problem& problem, const std::string& what,
                                           const std::vector<Guess>& guesses) {
  return solve(problem, what, guesses, false);
}

}  // namespace fjr
