// From a guess to a converged solution: friction made exact step by step, the mesh refined where it errs, margins
// widened until the limits hold between the collocation points.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"
#include "planner/search/continuation_strategy.h"
#include "planner/search/guesses.h"
#include "planner/search/session.h"

namespace fjr {

// Whether one of these minima is this one, by their objectives on the same mesh.
bool any_same(const std::vector<double>& minima, double objective);

// What a start came to.
enum class StartOutcome {
  kNoSolution,
  kKnown,  // a minimum that was met before
  kNew,
};

// What became of a change to a problem that was to be solved again.
enum class ChangeOutcome {
  kNotNeeded,  // there was nothing to change
  kSolved,     // the solution is that of the changed problem
  kFailed      // no solution of it was found: the last one stays
};

class Continuation {
 public:
  // label: of this start, for progress and stages. The session outlives it.
  Continuation(std::shared_ptr<const Problem> problem, Session& session, std::string label);

  // Solves with the smoothest friction law, on a coarse mesh from the guess and then on a refined one: what the starts
  // are compared by. status() says how it ended. `known`: objectives on first meshes; a minimum among them is not
  // refined again, nor what comes to much more than the least.
  StartOutcome begin(const Guess& guess, int most_iterations, const std::vector<double>& known = {});

  // From the refined solution of a neighbouring problem - other start, other goal - to this one's, on its mesh. False
  // when there is no solution that way.
  bool resume(const Collocated& neighbour);

  // From a solution of the same request with another objective, stretched to `duration` [s], on its mesh and with its
  // friction law. False when there is no solution that way.
  bool adopt(const Collocated& other, double duration);

  // From there one step of the homotopy nearer to the exact friction law, not yet minding the mesh. Returns whether
  // further steps can follow it; after the last one, or one that failed, the best solution so far is the result.
  bool take_step();

  // From the best solution of the steps so far to the exact problem, on a mesh and with margins that suit it. False
  // when no usable solution is left.
  bool settle();

  // All steps that can be taken, to the exact friction law; and from there to the exact problem. False when it was
  // stopped, or no usable solution is left.
  bool follow_homotopy();
  bool refine();

  // Splits the intervals of solution() whose given errors [rad] exceed the mesh tolerance or make most of their sum, or
  // whose limits are exceeded by much, and solves again.
  ChangeOutcome split_intervals(const std::vector<double>& errors);

  // Solves again with finer intervals and margins until the mesh is good enough and every limit holds between the
  // collocation points too. False when no usable solution is left.
  bool tighten();

  // The same where a certificate found limits of the published rows exceeded: interpolation between rows can do what
  // the collocation polynomial does not. (What exceeds them in a rollout only is not exact enough.)
  ChangeOutcome keep_margins(const std::vector<LimitCheck>& checks);

  // Solves again with motors kept from resting where they cannot (creep.h).
  ChangeOutcome creep();

  // From here on it is counted and stopped by this session, which outlives it.
  void go_on_in(Session& session) { session_ = &session; }

  const std::shared_ptr<const Problem>& problem() const { return problem_; }
  const std::string& label() const { return label_; }
  const Collocated& solution() const { return solution_; }
  double duration() const { return solution_.motion.duration(); }  // of the solution [s]
  bool has_exact_friction() const { return solution_.setup.smoothing.friction_width == 0; }
  SolveStatus status() const { return status_; }
  // The limit that the last attempt without solution exceeds most, as a sentence; empty if it exceeds none.
  const std::string& obstacle() const { return obstacle_; }
  const std::vector<SolverStage>& stages() const { return stages_; }
  int solutions() const { return solutions_; }  // that were found so far, each in place of the one before

  int start = 1;                     // how many starts had been tried with this one
  double mesh_factor = 1;            // on the number of intervals of the first mesh
  double regularisation_factor = 1;  // on that of the first solution, by effort: with more it is easier to solve
  double width_factor = 1;  // on the width of the first solution's friction law: less of it is nearer to the exact law
  bool by_own_method = false;     // the first solution too, where that suits it, and not by Ipopt
  double patience = 1;            // on the iterations of warm starts and of homotopy steps
  ContinuationStrategy strategy;  // the usual one, unless another is set before it begins

 private:
  // What an attempt from the present solution depends on beside that.
  struct Attempt {
    CollocationSetup setup;
    enum How { kFromGuess, kWarm, kMovingNodes } how = kFromGuess;
    int most_iterations = 0;
    double barrier = 0;
    SolveStatus status = SolveStatus::kFailed;  // it ended with

    bool same_as(const Attempt& other) const;
  };

  // How far the homotopy was followed.
  struct Homotopy {
    std::size_t next;  // step
    Collocated best;   // solution so far
    int best_at;       // solutions_ then
    double least;      // objective, of the best, as it would be published
  };

  bool cold(const Guess& guess, int most_iterations);
  void compare_step();
  bool keep_best_step();
  bool fade_regularisation();
  bool move_nodes();
  bool tighten_on_moved_nodes();
  bool came_down() const;
  bool is_ahead_of(const std::vector<double>& known) const;
  bool reach_step(const Smoothing& step, int halvings);
  bool attempt_step(const std::string& what, const CollocationSetup& setup);
  std::size_t most_intervals() const;
  double mesh_tolerance() const;
  std::vector<int> affordable_pieces(const std::vector<double>& errors, double tolerance) const;
  CollocationSetup refined(CollocationSetup setup, std::vector<double> errors, double tolerance) const;
  bool attempt_or_forget(const std::string& what, const CollocationSetup& setup, const SolveOptions& o);
  bool attempt_anew(const std::string& what, const CollocationSetup& setup);
  bool attempt(const std::string& what, const CollocationSetup& setup, const Guess* guess, const SolveOptions& options);
  bool attempt_once(const std::string& what, Attempt attempt, const SolveOptions& options,
                    const std::function<Collocated(const SolveOptions&)>& solve);
  bool has_rests() const;
  void keep_lowest_peak(std::optional<Collocated> best);  // best: nothing where no round kept all limits
  const ContinuationSettings& settings() const { return session_->options().settings; }
  SolveOptions options(const std::string& what);
  SolveOptions warm(const std::string& what);
  SolveOptions loosely(const std::string& what);
  bool solved_loosely() const;
  void solve_to_the_end();

  std::shared_ptr<const Problem> problem_;
  Session* session_;
  std::string label_;
  Collocated solution_;
  SolveStatus status_ = SolveStatus::kFailed;
  double violation_ = 0;  // that the last attempt left of its constraints
  std::string obstacle_;
  std::vector<Attempt> failed_;  // from the present solution
  std::vector<SolverStage> stages_;
  std::optional<Homotopy> homotopy_;  // while it is followed
  int solutions_ = 0;
  int failures_to_tighten_ = 0;
};

}  // namespace fjr
