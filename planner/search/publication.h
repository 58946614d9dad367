// Publishes solutions as rows with a certificate.
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
  std::shared_ptr<const Problem> problem;  // the one that was solved; the request may have another goal or objective
  Collocated solution;
  Trajectory trajectory;
  Certificate certificate{};
  std::map<std::string, double>
      terms{};            // terms of the objective, of the rows, without their weights (also those of weight zero)
  double objective = 0;   // the requested one, of the rows
  bool too_long = false;  // it takes longer than was asked for
};

struct PublishResult {
  std::optional<Publication> last;  // certified or not; none if there are too many rows
  std::string failure;              // why there are no rows; empty if there are

  bool certified() const { return last && last->certificate.certified; }
};

// Samples a motion into rows (ocp/sampling.h). If there would be more than `most` of them, the sample period is
// increased up to the longest one that is allowed. row_error: [rad/s] allowed error of linear interpolation between
// rows; smaller values add rows where the torque changes fast.
Trajectory rows_of(Problem asked, const Motion& motion, double row_error, std::size_t most = kMaxRows);

// Publishes the solution of a continuation. If it is not certified, it is refined according to the certificate and
// published again, as long as that changes anything. asked: the request, with its own limits and duration.
PublishResult publish(Continuation& c, const Problem& asked, Session& session);

// Moments [s] at which the segments of these durations [s] end.
std::vector<double> segment_ends(const std::vector<double>& durations);

}  // namespace fjr
