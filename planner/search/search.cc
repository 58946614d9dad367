#include "planner/search/search.h"

#include <algorithm>

#include "planner/ocp/margins.h"
#include "planner/problem/task/task.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

// Fraction of a limit by which the last round may leave it exceeded: a margin that a certificate asks for takes it
// away.
constexpr double kHardly = 2 * kBaseMargin;
constexpr std::size_t kGuesses = 2;  // of the usual ones

}  // namespace

double mesh_factor_of_sketch(const Problem& problem, const Guess& guess) {
  constexpr double kUsual = 1;  // [s]
  return can_be_jumped_over(problem.task) ? 1 : std::min(1.0, kUsual / guess.duration());
}

Guess guess_of(const Continuation& solution) { return guess_of(solution.solution()); }

std::vector<Guess> Search::guesses(const Problem& problem) const {
  std::vector<Guess> all = first_guesses(problem, session_.settings().starts);
  if (all.size() > kGuesses) all.erase(all.begin() + kGuesses, all.end());
  return all;
}

bool Search::refine(Continuation& c, Exactness exactness) {
  if (exactness == Exactness::kSketch) return true;
  if (exactness == Exactness::kExactFriction) return c.follow_homotopy() == Completion::kFinished;
  if (c.refine() == Completion::kStopped) return false;
  const Collocated& found = c.solution();
  const PerLimit scales = limit_scales(*c.problem());
  for (const PerLimit& over : excesses(*c.problem(), found.setup.mesh, found.motion, 0)) {
    for (std::size_t i = 0; i < over.size(); ++i) {
      if (over[i] > kHardly * scales[i]) return false;
    }
  }
  return true;
}

std::optional<Continuation> Search::solve(const Problem& problem, const std::string& what,
                                          const std::vector<Guess>& guesses, Exactness exactness, int most_iterations) {
  const auto kept = std::make_shared<const Problem>(problem);
  last_sketch_.reset();
  for (const Guess& guess : guesses) {
    if (over()) break;
    const double mesh_factor = exactness == Exactness::kKeepsLimits ? 1 : mesh_factor_of_sketch(*kept, guess);
    Continuation c(kept, session_, "why not: " + what, {.mesh_factor = mesh_factor});
    const bool sketched = c.begin(guess, most_iterations) == StartOutcome::kNew,
               solved = sketched && refine(c, exactness);
    if (solved) return c;
    if (sketched) last_sketch_ = std::move(c);
  }
  return std::nullopt;
}

std::optional<Continuation> Search::solve(const Problem& problem, const std::string& what,
                                          const std::vector<Guess>& guesses, int most_iterations) {
  return solve(problem, what, guesses, Exactness::kExactFriction, most_iterations);
}

std::optional<Continuation> Search::plan(const Problem& problem, const std::string& what,
                                         const std::vector<Guess>& guesses) {
  return solve(problem, what, guesses, Exactness::kKeepsLimits, kMostIterations);
}

std::optional<Continuation> Search::sketch(const Problem& problem, const std::string& what,
                                           const std::vector<Guess>& guesses, int most_iterations) {
  return solve(problem, what, guesses, Exactness::kSketch, most_iterations);
}

std::optional<Continuation> Search::least_sketch(const Problem& problem, const std::string& what,
                                                 const std::vector<Guess>& guesses) {
  std::optional<Continuation> best;
  for (const Guess& guess : guesses) {
    auto c = sketch(problem, what, {guess}, kMostIterationsOfSlack);
    if (c && (!best || c->solution().report.objective < best->solution().report.objective)) best = std::move(c);
  }
  return best;
}

}  // namespace fjr
