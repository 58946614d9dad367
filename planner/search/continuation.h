// Continuation from a guess to a converged solution: the friction law is sharpened step by step (homotopy), the mesh
// is refined where its error is too large, and margins are widened until the limits hold between the collocation
// points.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"
#include "planner/search/attempts.h"
#include "planner/search/continuation_strategy.h"
#include "planner/search/guesses.h"
#include "planner/search/homotopy.h"
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

// Result of solving a problem from the solution of a neighbouring one.
enum class ResumeOutcome {
  kOtherSegments,     // the neighbour passes another number of via points: it was not tried
  kOtherConstraints,  // it was planned with other constraints, or another number: it was not tried
  kNoSolution,
  kStopped,  // by the session: a solution may be there, but it is not finished
  kSolved,
};

struct ContinuationOptions {
  double mesh_factor = 1;  // on the number of intervals of the first mesh
  // Factor on the regularisation of the first solution; with more of it that is easier to find.
  double regularisation_factor = 1;
  double width_factor = 1;  // factor on the width of the first solution's friction law; smaller is nearer to exact
  // Finds the first solution by our interior-point method instead of Ipopt, if that suits.
  bool by_interior_point = false;
  // Our method begins with this barrier, because the guess is nearly a solution.
  std::optional<double> barrier{};
  double iteration_factor = 1;                     // factor on the iterations of warm starts and homotopy steps
  std::optional<ContinuationStrategy> strategy{};  // the usual one, unless another is given
};

class Continuation {
 public:
  // label: names the start in progress reports and stages. The session must outlive this object.
  Continuation(std::shared_ptr<const Problem> problem, Session& session, std::string label,
               ContinuationOptions options = {});

  // Solves with the smoothest friction law on a coarse mesh and, if the objective depends on friction, again on a
  // refined mesh. Starts are compared by the result. known: objectives of other starts on their first meshes; a minimum
  // among them is not refined again, nor one that costs much more than the least. status() tells how the solve ended.
  StartOutcome begin(const Guess& guess, int most_iterations, const std::vector<double>& known = {});

  // Solves this problem from the refined solution of a neighbouring one, beginning on its mesh: at that solution, or at
  // the quadratic program there, if other limits are active in this one (another start or goal).
  ResumeOutcome resume(const Collocated& neighbour, Beginning beginning = Beginning::kMultipliers);

  // Solves this problem from a solution of the same request with another objective, stretched to `duration` [s], on its
  // mesh and with its friction law. Returns whether that gives a solution.
  bool adopt(const Collocated& other, double duration);

  // Solves this problem from a motion that is nearly a solution of it, on its mesh, with a friction law of this width
  // [rad/s]. barrier: at first; smaller ones stay closer to bounds. Returns whether that gives a solution.
  bool take_over(const Collocated& motion, double friction_width, double barrier, int most_iterations);

  // Takes one homotopy step towards the exact friction law, with a loose mesh tolerance. Where none is left, the best
  // solution so far is the result.
  StepOutcome take_step();

  // Adapts mesh and margins to the best solution of the steps so far, until every limit holds between the collocation
  // points. (If no solution with margins is found, the certificate decides about the last one.)
  Completion settle();

  // follow_homotopy() takes all steps of the homotopy; refine() takes them and then settles.
  Completion follow_homotopy();
  Completion refine();

  // Splits the intervals of solution() whose errors [rad] exceed the mesh tolerance or make up most of their sum, and
  // those that exceed limits by much, and solves again. Throws std::logic_error unless there is one error per interval.
  ChangeOutcome split_intervals(const std::vector<double>& errors);

  // Solves again with finer intervals and margins until the mesh is good enough and every limit holds between the
  // collocation points too.
  Completion tighten();

  // Widens margins where the published rows exceed limits, and solves again: interpolation between rows may exceed what
  // the collocation polynomial keeps.
  ChangeOutcome keep_margins(const std::vector<LimitCheck>& checks);

  // Widens the margins of limits that only the rollout exceeds, and solves again, for where more accuracy has not
  // helped.
  ChangeOutcome keep_margins_of_rollout(const std::vector<LimitCheck>& checks);

  // Solves again with motors kept moving where they would rest for `shortest` [s] and more, and unstably (creep.h).
  ChangeOutcome creep(double shortest);

  // Continues in another session, which counts the work and can stop it. The session must outlive this object.
  void go_on_in(Session& session) { attempts_.go_on_in(session); }

  const std::shared_ptr<const Problem>& problem() const { return attempts_.shared_problem(); }
  const std::string& label() const { return attempts_.label(); }
  const Collocated& solution() const { return attempts_.solution(); }
  double duration() const { return solution().motion.duration(); }  // of the solution [s]
  bool has_sharpest_friction() const {
    return solution().setup.smoothing.friction_width <= strategy_.steps.back().friction_width;
  }
  SolveStatus status() const { return attempts_.status(); }  // of the last attempt
  // The limit that the last attempt without solution exceeds most, as a sentence; empty if it exceeds none.
  const std::string& obstacle() const { return attempts_.obstacle(); }
  const std::vector<SolverStage>& stages() const { return attempts_.stages(); }
  int solutions() const { return attempts_.solutions(); }  // number so far; each replaced the one before

  int start = 1;  // number of starts tried so far, this one included

 private:
  Completion keep_best_step();

  ContinuationOptions options_;
  ContinuationStrategy strategy_;
  Attempts attempts_;
  std::optional<Homotopy> homotopy_;  // while it is followed
  int failures_to_tighten_ = 0;
};

}  // namespace fjr
