#include "planner/search/search.h"

#include <algorithm>

#include "planner/ocp/margins.h"
#include "planner/problem/task/task.h"
#include "planner/search/starts.h"

namespace fjr {
double mesh_factor_of_sketch(const Problem& problem, const Guess& guess, const ExplanationSolveSettings& settings) {
  return can_be_jumped_over(problem.task) ? 1 : std::min(1.0, settings.longest_on_full_mesh / guess.duration());
}

Guess guess_of(const Continuation& solution) { return guess_of(solution.solution()); }

std::vector<Guess> Search::guesses(const Problem& problem) const {
  std::vector<Guess> all = first_guesses(problem, session_.settings().starts);
  all.resize(std::min(all.size(), settings().solves.guesses));
  return all;
}

bool Search::refine(Continuation& c, Exactness exactness) const {
  if (exactness == Exactness::kSketch) return true;
  if (exactness == Exactness::kExactFriction) return c.follow_homotopy() == Completion::kFinished;
  if (c.refine() == Completion::kStopped) return false;
  const Collocated& found = c.solution();
  const PerLimit scales = limit_scales(*c.problem());
  const double hardly = settings().solves.exceeded * kBaseMargin;  // a fraction of a limit
  for (const PerLimit& over : excesses(*c.problem(), found.setup.mesh, found.motion, 0)) {
    for (std::size_t i = 0; i < over.size(); ++i) {
      if (over[i] > hardly * scales[i]) return false;
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
    const double mesh_factor =
        exactness == Exactness::kKeepsLimits ? 1 : mesh_factor_of_sketch(*kept, guess, settings().solves);
    Continuation c(kept, session_, "explanation: " + what, {.mesh_factor = mesh_factor});
    const bool sketched = c.begin(guess, most_iterations) == StartOutcome::kNew,
               solved = sketched && refine(c, exactness);
    if (solved) return c;
    if (sketched) last_sketch_ = std::move(c);
  }
  return std::nullopt;
}

std::optional<Continuation> Search::solve(const Problem& problem, const std::string& what,
                                          const std::vector<Guess>& guesses, std::optional<int> most_iterations) {
  return solve(problem, what, guesses, Exactness::kExactFriction,
               most_iterations.value_or(settings().solves.iterations));
}

std::optional<Continuation> Search::plan(const Problem& problem, const std::string& what,
                                         const std::vector<Guess>& guesses) {
  return solve(problem, what, guesses, Exactness::kKeepsLimits, settings().solves.iterations);
}

std::optional<Continuation> Search::sketch(const Problem& problem, const std::string& what,
                                           const std::vector<Guess>& guesses, std::optional<int> most_iterations) {
  return solve(problem, what, guesses, Exactness::kSketch, most_iterations.value_or(settings().solves.iterations));
}

std::optional<Continuation> Search::least_sketch(const Problem& problem, const std::string& what,
                                                 const std::vector<Guess>& guesses) {
  std::optional<Continuation> best;
  for (const Guess& guess : guesses) {
    auto c = sketch(problem, what, {guess}, settings().solves.iterations_of_slack);
    if (c && (!best || c->solution().report.objective < best->solution().report.objective)) best = std::move(c);
  }
  return best;
}

}  // namespace fjr
