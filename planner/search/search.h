// The solves that a question or an explanation may spend: each from its guesses, all of them within a budget that is
// counted in the optimiser's work and not in time, so that the same request is told the same every time.
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
  static constexpr double kBudget = 10;        // [s] of work (SolveReport::work)
  static constexpr int kMostIterations = 450;  // of one start
  static constexpr int kMostIterationsOfSlack =
      250;  // of one that minimises a slack: those that lead somewhere took up to 190

  explicit Search(Session& session, double budget = kBudget)
      : session_(session), budget_(budget), work_before_(session.account().work) {}

  // What is left of the budget [s].
  double left() const { return budget_ - (session_.account().work - work_before_); }

  // Nothing more will be solved: interrupted, or the budget is spent.
  bool over() const { return session_.interrupted() || left() <= 0; }

  // The first solution from one of these guesses, with the exact friction law.
  std::optional<Continuation> solve(const Problem& problem, const std::string& what, const std::vector<Guess>& guesses,
                                    int most_iterations = kMostIterations);

  // The same on a mesh and with margins that keep every limit between the collocation points too.
  std::optional<Continuation> plan(const Problem& problem, const std::string& what, const std::vector<Guess>& guesses);

  // The same only as exact as finding it takes: on a coarse mesh, with friction smoothed.
  std::optional<Continuation> sketch(const Problem& problem, const std::string& what, const std::vector<Guess>& guesses,
                                     int most_iterations = kMostIterations);

  // The least objective of what all of these guesses lead to, as exact as that.
  std::optional<Continuation> least_sketch(const Problem& problem, const std::string& what,
                                           const std::vector<Guess>& guesses);

  // What the last solve() came to with friction smoothed, where it did not get to the exact law; none otherwise.
  std::optional<Continuation> last_sketch() const { return last_sketch_; }

  // Where there is nothing better to start from.
  std::vector<Guess> guesses(const Problem& problem) const;

 private:
  enum class Exactness { kSketch, kExactFriction, kKeepsLimits };
  std::optional<Continuation> solve(const Problem& problem, const std::string& what, const std::vector<Guess>& guesses,
                                    Exactness exactness, int most_iterations);
  static bool refine(Continuation& c, Exactness exactness);

  Session& session_;
  const double budget_, work_before_;  // [s]
  std::optional<Continuation> last_sketch_;
};

// A solution as the start of a neighbouring problem.
Guess guess_of(const Continuation& solution);

}  // namespace fjr
