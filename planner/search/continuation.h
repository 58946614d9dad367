// Continuation from a guess to a converged solution: the friction law is made exact step by step (homotopy), the mesh
// is refined where its error is too large, and margins are widened until the limits hold between the collocation
// points.
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

// Returns whether an objective equals one of these minima to within a relative difference, so that both are the same
// minimum. All objectives must be of the same mesh.
bool any_same(const std::vector<double>& minima, double objective, double difference);

// Result of a start.
enum class StartOutcome {
  kNoSolution,
  kKnown,  // a minimum that was found before
  kNew,
};

// Result of changing the problem and solving it again.
enum class ChangeOutcome {
  kNotNeeded,  // there was nothing to change
  kSolved,     // the solution is that of the changed problem
  kFailed      // no solution of it was found: the last one stays
};

class Continuation {
 public:
  // label: names the start in progress reports and stages. The session must outlive this object.
  Continuation(std::shared_ptr<const Problem> problem, Session& session, std::string label);

  // Solves with the smoothest friction law on a coarse mesh and, if the objective depends on friction, again on a
  // refined mesh. Starts are compared by the result. known: objectives of other starts on their first meshes; a minimum
  // among them is not refined again, nor one that costs much more than the least. status() tells how the solve ended.
  StartOutcome begin(const Guess& guess, int most_iterations, const std::vector<double>& known = {});

  // Solves this problem from the refined solution of a neighbouring one (another start or goal), beginning on its mesh.
  // Returns false if that gives no solution.
  bool resume(const Collocated& neighbour);

  // Solves this problem from a solution of the same request with another objective, stretched to `duration` [s], on its
  // mesh and with its friction law. Returns false if that gives no solution.
  bool adopt(const Collocated& other, double duration);

  // Takes one homotopy step towards the exact friction law, with a loose mesh tolerance. Returns false if no step was
  // left or the step failed; the best solution so far is then the result.
  bool take_step();

  // Adapts mesh and margins to the best solution of the steps so far, until every limit holds between the collocation
  // points. Returns false if no usable solution is left.
  bool settle();

  // follow_homotopy() takes all steps to the exact friction law; refine() takes them and then settles. They return
  // false if the search was stopped or no usable solution is left.
  bool follow_homotopy();
  bool refine();

  // Splits the intervals of solution() whose errors [rad] exceed the mesh tolerance or make up most of their sum, and
  // those that exceed limits by much, and solves again. Throws std::logic_error unless there is one error per interval.
  ChangeOutcome split_intervals(const std::vector<double>& errors);

  // Solves again with finer intervals and margins until the mesh is good enough and every limit holds between the
  // collocation points too. False when no usable solution is left.
  bool tighten();

  // Widens margins where the published rows exceed limits, and solves again: interpolation between rows may exceed what
  // the collocation polynomial keeps. (A limit exceeded only in the rollout needs more accuracy, not a margin.)
  ChangeOutcome keep_margins(const std::vector<LimitCheck>& checks);

  // Solves again with motors kept moving where their rest would be unstable (creep.h).
  ChangeOutcome creep();

  // Continues in another session, which counts the work and can stop it. The session must outlive this object.
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
  int solutions() const { return solutions_; }  // number of solutions so far; each replaced the one before

  int start = 1;           // number of starts tried so far, this one included
  double mesh_factor = 1;  // on the number of intervals of the first mesh
  // Factor on the regularisation of the first solution; with more of it that is easier to find.
  double regularisation_factor = 1;
  double width_factor = 1;     // factor on the width of the first solution's friction law; smaller is nearer to exact
  bool by_own_method = false;  // finds the first solution by our interior-point method instead of Ipopt, if that suits
  double patience = 1;         // factor on the iterations of warm starts and homotopy steps
  ContinuationStrategy strategy;  // the usual one, unless another is set before it begins

 private:
  // What the result of an attempt depends on, besides the present solution. A failed attempt is not repeated.
  struct Attempt {
    CollocationSetup setup;
    enum How { kFromGuess, kWarm, kMovingNodes } how = kFromGuess;
    int most_iterations = 0;
    double barrier = 0;
    SolveStatus status = SolveStatus::kFailed;  // it ended with

    bool same_as(const Attempt& other) const;
  };

  // State of the homotopy.
  struct Homotopy {
    std::size_t next;  // index of the next step
    Collocated best;   // solution so far
    int best_at;       // value of solutions_ when it was found
    double least;      // its objective as it would be published
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
  void keep_lowest_peak(std::optional<Collocated> best);  // best: empty if no round kept all limits
  const ContinuationSettings& settings() const { return session_->settings().continuation; }
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
  double violation_ = 0;  // of the constraints at the end of the last attempt
  std::string obstacle_;
  std::vector<Attempt> failed_;  // attempts that failed from the present solution
  std::vector<SolverStage> stages_;
  std::optional<Homotopy> homotopy_;  // while it is followed
  int solutions_ = 0;
  int failures_to_tighten_ = 0;
};

}  // namespace fjr
