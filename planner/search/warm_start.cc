#include "planner/search/warm_start.h"

#include <fmt/format.h>

#include <utility>

#include "planner/search/publication.h"

namespace fjr {

std::optional<std::string> start_warm(const Collocated& neighbour, Findings& found, Session& session) {
  const Timed timed(session, "warm");
  if (const std::string& method = neighbour.setup.scheme.name; method != found.asked.method) {
    return fmt::format("it was planned with method {}, and {} is asked for", method, found.asked.method);
  }
  std::optional<std::string> refusal;
  for (const auto& alternative : found.alternatives) {
    Continuation c(alternative, session, "from an earlier plan");
    const ResumeOutcome outcome = c.resume(neighbour, Beginning::kQuadraticProgram);
    bool too_long = false;
    std::string why;
    if (outcome == ResumeOutcome::kSolved) {
      PublishResult published = publish(c, found.asked, session);
      too_long = published.last && published.last->too_long;
      why = published.failure;
      if (why.empty() && published.last && !published.certified()) why = published.last->certificate.failures.front();
      if (found.keep(c, std::move(published))) return std::nullopt;
    }
    if (session.stopped()) return "it was stopped before a plan was found";
    if (outcome == ResumeOutcome::kOtherSegments) {
      refusal = "it passes another number of via points";
    } else if (outcome == ResumeOutcome::kOtherConstraints) {
      refusal = "it was planned with other constraints, or another number of them";
    } else if (outcome == ResumeOutcome::kStopped || (outcome == ResumeOutcome::kSolved && why.empty() && !too_long)) {
      refusal = "the work that is allowed was used up before a plan was found";
    } else if (outcome == ResumeOutcome::kNoSolution) {
      refusal = "the optimiser did not converge from it";
    } else if (too_long) {
      refusal = fmt::format("the plan found from it takes {:.4f} s, more than is allowed", c.duration());
    } else {
      refusal = "the plan found from it was not certified: " + why;
    }
  }
  return refusal;
}

}  // namespace fjr
