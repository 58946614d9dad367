// From a solution to rows that are certified.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"
#include "planner/search/continuation.h"
#include "planner/trajectory/motion.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// A solution as it is published.
struct Publication {
  std::shared_ptr<const Problem> problem;  // that was solved; what was asked for may have another goal, or objective
  Collocated solution;
  Trajectory trajectory;
  Certificate certificate{};
  std::map<std::string, double> terms{};  // of the objective, of the rows; unweighted, weighted or not
  double objective = 0;                   // that was asked for, of the rows
  bool too_long = false;                  // it takes longer than was asked for
};

struct PublishResult {
  std::optional<Publication> last;  // certified or not; none where rows could not be made
  std::string failure;              // why the last attempt gave no rows; empty where it did

  bool certified() const { return last && last->certificate.certified; }
};

// Rows of a motion (ocp/sampling.h), farther apart than is usual where there would be more than `most` of them, unless
// their distance was asked for. A motion that is published again with finer rows has those where its torque asks for
// them, and so needs fewer elsewhere.
Trajectory rows_of(Problem asked, const Motion& motion, double row_error, std::size_t most = kMaxRows);

// Publishes what a continuation came to. Where it is not certified, the solution is refined for what is missing, and
// published again, as long as that changes anything. asked: with the limits and the duration that were asked for.
PublishResult publish(Continuation& c, const Problem& asked, Session& session);

// Moments [s] at which the segments of these durations [s] end.
std::vector<double> segment_ends(const std::vector<double>& durations);

}  // namespace fjr
