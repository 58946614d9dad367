// Solves of one problem, each starting from the solution of the last that succeeded: what all parts of a continuation
// share.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"
#include "planner/search/account.h"
#include "planner/search/continuation_strategy.h"
#include "planner/search/guesses.h"
#include "planner/search/session.h"

namespace fjr {

// Result of changing the problem and solving it again.
enum class ChangeOutcome {
  kNotNeeded,  // there was nothing to change
  kSolved,     // the solution is that of the changed problem
  kFailed      // no solution of it was found: the last one stays
};

// How a sequence of solves ended.
enum class Completion {
  kFinished,  // with the best solution that was found, even if the last attempts failed
  kStopped    // by the session, before it was finished
};

class Attempts {
 public:
  // label: names them in progress reports and stages. iteration_factor: factor on the iterations of most warm starts.
  // The session must outlive this object.
  Attempts(std::shared_ptr<const Problem> problem, Session& session, std::string label, double iteration_factor);

  // The following functions solve with another setup. They return true if they find a solution, which solution() is
  // from then on; otherwise solution() stays as it was, and status() is the reason. what: names the solve. An attempt
  // that failed from the present solution would fail again, so it is not repeated.
  bool from_guess(const std::string& what, const CollocationSetup& setup, const Guess& guess, const SolveOptions& o);

  // From the present solution and its multipliers, on its mesh or a finer one.
  bool warm(const std::string& what, const CollocationSetup& setup, const SolveOptions& o);

  // The same, where `start` was made of the present solution and of nothing else.
  bool warm_from(const Collocated& start, const std::string& what, const CollocationSetup& setup,
                 const SolveOptions& o);

  // From the present motion, without its multipliers and further from the bounds. This takes longer than a warm start,
  // and fails more rarely.
  bool anew(const std::string& what, const CollocationSetup& setup);

  // From the present solution, and if that fails and the strategy says so anew.
  bool warm_or_anew(const std::string& what, const CollocationSetup& setup, const SolveOptions& o,
                    const ContinuationStrategy& strategy);

  // On the present mesh, with the times of these nodes as decision variables (planner/ocp/moving_nodes.h).
  bool moving_nodes(const std::string& what, const std::vector<std::size_t>& nodes, const SolveOptions& o);

  // Options of a solve from a guess; of a warm start; and of one that another follows, with larger tolerances if the
  // objective does not depend on friction or is a peak. They must not outlive this object.
  SolveOptions options(const std::string& what);
  SolveOptions warm_options(const std::string& what);
  SolveOptions loose_options(const std::string& what);

  // Puts another solution in the place of the present one. It does not count as one that was found.
  void replace(Collocated solution);

  void forget_stages() { stages_.clear(); }

  // Continues in another session, which counts the work and can stop it. The session must outlive this object.
  void go_on_in(Session& session) { session_ = &session; }

  const Problem& problem() const { return *problem_; }
  const std::shared_ptr<const Problem>& shared_problem() const { return problem_; }
  Session& session() const { return *session_; }
  const ContinuationSettings& settings() const { return session_->settings().continuation; }
  const std::string& label() const { return label_; }
  double iteration_factor() const { return iteration_factor_; }

  const Collocated& solution() const { return solution_; }
  int solutions() const { return solutions_; }    // number of solutions so far; each replaced the one before
  SolveStatus status() const { return status_; }  // of the last attempt
  bool stopped() const { return status_ == SolveStatus::kStopped; }
  Completion completion() const { return stopped() ? Completion::kStopped : Completion::kFinished; }
  double violation() const { return violation_; }      // of the constraints at the end of the last attempt
  bool start_fitted() const { return start_fitted_; }  // the last attempt's start had the variables of its problem
  // The limit that the last attempt without solution exceeds most, as a sentence; empty if it exceeds none.
  const std::string& obstacle() const { return obstacle_; }
  const std::vector<SolverStage>& stages() const { return stages_; }

  // Whether the last attempt, although it found no solution, lowered the objective by a fraction worth continuing for.
  bool came_down() const;

  // Whether friction is in the objective, so that a motor may rest and carry a load at no cost.
  bool has_rests() const { return sees_friction(problem_->weights) && !problem_->variation.slack; }

 private:
  // What the result of an attempt depends on, besides the present solution.
  struct Attempt {
    CollocationSetup setup;
    enum How { kFromGuess, kWarm, kMovingNodes } how = kFromGuess;
    int most_iterations = 0;
    double barrier = 0;
    Beginning beginning = Beginning::kPoint;
    SolveStatus status = SolveStatus::kFailed;  // it ended with

    bool same_as(const Attempt& other) const;
  };

  bool attempt(const std::string& what, Attempt attempt, const SolveOptions& o,
               const std::function<Collocated(const SolveOptions&)>& solve);

  std::shared_ptr<const Problem> problem_;
  Session* session_;
  std::string label_;
  double iteration_factor_;
  Collocated solution_;
  int solutions_ = 0;
  SolveStatus status_ = SolveStatus::kFailed;
  double violation_ = 0;
  bool start_fitted_ = true;
  std::string obstacle_;
  std::vector<Attempt> failed_;  // from the present solution
  std::vector<SolverStage> stages_;
};

}  // namespace fjr
