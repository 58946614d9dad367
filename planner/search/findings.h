// Intermediate results of the search for one request.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/search/continuation.h"
#include "planner/search/out_of_reach.h"
#include "planner/search/publication.h"
#include "planner/search/race.h"
#include "planner/search/settings.h"
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

// The result of the first start of an alternative's fastest motion, which is tried early to see whether the request
// seems to allow too little time.
struct FastestSketch {
  std::shared_ptr<const Problem> alternative;
  std::optional<Continuation> motion;  // on a coarse mesh, with smoothed friction; none if the start led nowhere
};

// Limits with which the arm was found to swing up to one of the alternative goals.
struct SwingUpLimits {
  std::shared_ptr<const Problem> alternative;
  Limits limits;
};

struct Findings {
  explicit Findings(const Problem& asked, const FollowSettings& settings = {});

  const Problem& asked;  // outlives this
  double scale;          // of the objective: what is optimised is divided by it, see objective_scale()
  std::vector<std::shared_ptr<const Problem>>
      alternatives;  // problems that are optimised: one for each goal that is allowed

  int starts = 0;                          // that were solved
  int starts_planned = 0;                  // that are solved in any case
  int refined = 0;                         // candidates that were followed to the exact problem
  int start_iterations;                    // that a start may take
  std::vector<CoarseMotion> candidates;    // in the order in which they were found
  std::vector<Continuation> waiting;       // to be refined while the next starts are tried
  std::vector<double> minima;              // scaled objectives of the distinct minima on their first meshes
  StepObjectives reached;                  // objectives after the homotopy steps
  std::optional<Publication> best;         // the best certified one, or the last one if none is certified
  std::optional<Fastest> fastest;          // the shortest motion found, if it was looked for
  std::vector<FastestSketch> sketches;     // of fastest motions, at most one of each alternative
  std::optional<SwingUpLimits> swing_up;   // the least limits with which the arm was found to swing up
  bool swing_was_cut = false;              // more work might have found motions with tighter limits
  std::optional<OutOfReach> out_of_reach;  // clearly infeasible, so that no more was tried
  bool a_start_was_infeasible = false;     // the optimiser found a start infeasible, not only slow to converge
  std::string obstacle;                    // what a start without solution failed at, a clause
  std::string failure;                     // why a solution could not be published
  bool certified_for_the_robot = false;    // before margins for other arms were looked for

  bool certified() const { return best && best->certificate.certified; }

  // Returns whether even the fastest motion takes longer than is allowed.
  bool too_short() const { return fastest && fastest->duration() > asked.duration.max; }

  // Keeps a published motion as the best if it is better than the present one. A motion longer than is allowed is kept
  // as the fastest motion instead. Returns whether it is certified and not too long.
  bool keep(const Continuation& c, PublishResult published);

  // Keeps a certified plan if it is better than the present one.
  void keep(Publication plan);

  // Keeps a fastest motion if it is shorter than the one known, or a later state of that one.
  void note_fastest(const Continuation& c, bool certified);
};

}  // namespace fjr
