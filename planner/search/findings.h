// What the search has found for one request, as far as it has come.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/search/continuation.h"
#include "planner/search/out_of_reach.h"
#include "planner/search/publication.h"
#include "planner/search/race.h"
#include "planner/search/worth_refining.h"
#include "planner/trajectory/motion.h"

namespace fjr {

// A motion on its refined first mesh.
struct CoarseMotion {
  std::shared_ptr<const Problem> problem;
  CoarseSolution coarse;
  Motion motion;
  std::vector<double> durations;  // [s] of its segments
};

// The fastest motion of an alternative.
struct Fastest {
  Continuation motion;
  bool certified;  // its rows are exact enough to be published
  std::shared_ptr<const Problem> alternative;

  double duration() const { return motion.solution().motion.duration(); }  // [s]
};

struct Findings {
  explicit Findings(const Problem& asked);

  const Problem& asked;  // outlives this
  double scale;          // of the objective: what is optimised is divided by it, see size_of(Weights)
  std::vector<std::shared_ptr<const Problem>>
      alternatives;  // what is optimised: one problem for each goal that will do

  int starts = 0;                          // that were solved
  int starts_planned = 0;                  // that are solved in any case
  int refined = 0;                         // candidates that were followed to the exact problem
  int patience = 400;                      // iterations a start may take
  std::vector<CoarseMotion> candidates;    // in the order in which they were found
  std::vector<Continuation> waiting;       // to be refined while the next starts are tried
  std::vector<double> minima;              // objectives of the distinct ones, as optimised, on their first meshes
  StepObjectives reached;                  // on the way from there to exact friction
  std::optional<Publication> best;         // certified; or the last one that is not, where none is
  std::optional<Fastest> fastest;          // once it was looked for, the shortest that there is
  std::optional<Limits> carried_with;      // limits with which the arm was found to swing up
  bool swing_was_cut = false;              // more work might have found it with tighter ones
  std::optional<OutOfReach> out_of_reach;  // clearly, so that no more was tried
  bool a_start_was_infeasible = false;     // and not only difficult
  std::string obstacle;                    // what a start without solution failed at, a clause
  std::string failure;                     // why a solution could not be published

  bool certified() const { return best && best->certificate.certified; }

  // Even the fastest motion takes longer than was asked for.
  bool too_short() const { return fastest && fastest->duration() > asked.duration.max; }

  // Stores what was published as the best, if it is better than that; what takes longer than was asked for, as the
  // fastest motion. True when it is a certified plan.
  bool keep(const Continuation& c, PublishResult published);

  // A motion that is as fast as can be.
  void note_fastest(const Continuation& c, bool certified);
};

}  // namespace fjr
