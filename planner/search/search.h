// Solves for explanations and for the question whether a request is out of reach. They share a budget, which is counted
// in the optimiser's work and not in time, so that the same request always gets the same answer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"
#include "planner/search/continuation.h"
#include "planner/search/guesses.h"
#include "planner/search/session.h"

namespace fjr {

class Search {
 public:
  // budget: [s] of work (SolveReport::work); without one it is that of an explanation.
  Search(Session& session, double budget) : session_(session), budget_(budget), work_before_(session.account().work) {}
  explicit Search(Session& session) : Search(session, session.settings().explanation.solves.budget) {}

  const ExplanationSettings& settings() const { return session_.settings().explanation; }

  // Returns what is left of the budget [s of work].
  double left() const { return budget_ - (session_.account().work - work_before_); }

  // Returns whether nothing more will be solved: interrupted, or the budget is spent.
  bool over() const { return session_.interrupted() || left() <= 0; }

  // Returns the first solution from one of these guesses, with the exact friction law; nothing if all fail.
  // most_iterations: of one start; those of the settings, unless others are given.
  std::optional<Continuation> solve(const Problem& problem, const std::string& what, const std::vector<Guess>& guesses,
                                    std::optional<int> most_iterations = {});

  // Does the same on a mesh and with margins that keep every limit between the collocation points too.
  std::optional<Continuation> plan(const Problem& problem, const std::string& what, const std::vector<Guess>& guesses);

  // Does the same on a coarse mesh with smoothed friction only, as Continuation::begin() does.
  std::optional<Continuation> sketch(const Problem& problem, const std::string& what, const std::vector<Guess>& guesses,
                                     std::optional<int> most_iterations = {});

  // Returns the sketch with the least objective from all of these guesses.
  std::optional<Continuation> least_sketch(const Problem& problem, const std::string& what,
                                           const std::vector<Guess>& guesses);

  // Returns the sketch of the last solve() that did not reach the exact law; nothing if there is none.
  std::optional<Continuation> last_sketch() const { return last_sketch_; }

  // Returns the usual guesses, for when there is nothing better to start from.
  std::vector<Guess> guesses(const Problem& problem) const;

 private:
  enum class Exactness { kSketch, kExactFriction, kKeepsLimits };
  std::optional<Continuation> solve(const Problem& problem, const std::string& what, const std::vector<Guess>& guesses,
                                    Exactness exactness, int most_iterations);
  bool refine(Continuation& c, Exactness exactness) const;

  Session& session_;
  const double budget_, work_before_;  // [s]
  std::optional<Continuation> last_sketch_;
};

// Returns the factor on the number of intervals of a sketch's first mesh. Long motions are begun with as many intervals
// as one that takes longest_on_full_mesh, unless they could jump over obstacles then.
double mesh_factor_of_sketch(const Problem& problem, const Guess& guess, const ExplanationSolveSettings& settings);

// Returns a solution as a guess for a neighbouring problem.
Guess guess_of(const Continuation& solution);

}  // namespace fjr
