#include "planner/search/publication.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "planner/certificate/certificate.h"
#include "planner/certificate/judge.h"
#include "planner/certificate/request_check.h"
#include "planner/ocp/objective.h"
#include "planner/ocp/sampling.h"
#include "planner/search/refinement.h"

namespace fjr {
namespace {

constexpr double kSameDuration = 1e-9;  // fraction by which a duration may differ from its bound, for rounding

Publication with_certificate(const Continuation& c, const Problem& asked, Trajectory trajectory, Session& session) {
  const Collocated& solution = c.solution();
  Publication p{.problem = c.problem(), .solution = solution, .trajectory = std::move(trajectory)};
  p.certificate = certify(asked.robot, asked.limits, p.trajectory, session.side_by_side());
  check_against_request(*c.problem(), segment_ends(solution.durations), p.trajectory, p.certificate);
  p.terms = objective_terms(asked, solution, p.trajectory);
  p.objective = weighted_sum(asked.weights, p.terms);
  p.too_long = p.trajectory.end_time() > asked.duration.max * (1 + kSameDuration);
  p.trajectory.metadata["robot_hash"] = robot_hash(asked.robot);
  p.trajectory.metadata["request_hash"] = asked.request_hash;
  return p;
}

// Returns the error [rad] of each interval: the local error of the published rows against the exact model, but no less
// than the mesh's own estimate, which is also used where the rollout gives none.
std::vector<double> rollout_errors(const Parameters& robot, const Collocated& solution, const Trajectory& trajectory) {
  std::vector<double> errors = interval_errors(robot, solution.motion);
  const auto local = local_errors(robot, trajectory, solution.setup.mesh.node_times(solution.durations));
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (const double size = error_size(local[k]); std::isfinite(size)) errors[k] = std::max(errors[k], size);
  }
  return errors;
}

// Returns whether the arm follows the rows as it should, and exceeds limits all the same.
bool only_limits_fail(const Certificate& certificate) {
  const auto exceeded = std::count_if(certificate.limits.begin(), certificate.limits.end(),
                                      [](const LimitCheck& check) { return !check.passed; });
  return static_cast<std::size_t>(exceeded) == certificate.failures.size();
}

}  // namespace

Trajectory rows_of(Problem asked, const Motion& motion, double row_error, std::size_t most) {
  const auto farther_apart = [&] {
    if (asked.sample_period >= asked.longest_sample_period) return false;
    asked.sample_period = std::min(2 * asked.sample_period, asked.longest_sample_period);
    return true;
  };
  while (motion.duration() > asked.sample_period * static_cast<double>(most) && farther_apart()) continue;
  Trajectory rows = sample(asked, motion, row_error);
  while (rows.samples.size() > most && farther_apart()) rows = sample(asked, motion, row_error);
  return rows;
}

PublishResult publish(Continuation& c, const Problem& asked, Session& session) {
  const PublicationSettings& s = session.settings().publication;
  PublishResult published;
  double row_error = kRowVelocityError;
  std::size_t rows = 0;
  for (int round = 0; round < s.rounds && !session.interrupted(); ++round) {
    {
      const Timed timed(session, "certificate");
      const Motion motion = with_integrated_positions(c.solution().motion, c.solution().setup.mesh);
      Trajectory trajectory = rows_of(asked, motion, row_error);
      if (trajectory.samples.size() > kMaxRows) {
        const bool longer_helps = asked.longest_sample_period < kLongestSamplePeriod &&
                                  c.duration() > asked.longest_sample_period * kMaxRows / 2;
        published.failure =
            fmt::format("the trajectory needs {} rows, more than the {} allowed{}", trajectory.samples.size(), kMaxRows,
                        longer_helps ? "; a longer sample_period would be enough" : " to follow its torque");
        return published;
      }
      published.last = with_certificate(c, asked, std::move(trajectory), session);
    }
    if (published.certified()) break;
    const Publication& refused = *published.last;
    const int solutions = c.solutions();
    // A limit that the rows exceed needs a margin, and an unstable rest needs a slow motion instead. Everything else
    // needs a more accurate solution and finer rows. After some rounds of that, shorter rests are kept from, too, and a
    // limit that only the rollout exceeds gets a margin, if nothing else is wrong with the rollout.
    const bool by_accuracy = round < s.rounds_by_accuracy;
    const double shortest_rest =
        session.settings().continuation.creep.shortest_rest * (by_accuracy ? 1 : s.shorter_rests);
    const bool margins_for_rollout = !by_accuracy && only_limits_fail(refused.certificate);
    const bool other_motion =
        c.keep_margins(refused.certificate.limits) == ChangeOutcome::kSolved ||
        (margins_for_rollout && c.keep_margins_of_rollout(refused.certificate.limits) == ChangeOutcome::kSolved) ||
        c.creep(shortest_rest) == ChangeOutcome::kSolved;
    if (session.interrupted()) break;
    if (!other_motion) {  // the errors belong to the intervals of this solution
      c.split_intervals(rollout_errors(asked.robot, refused.solution, refused.trajectory));
      row_error *= s.finer_rows;
    }
    c.tighten();
    // Without another solution or more rows the next verdict would be the same.
    if (c.solutions() == solutions && refused.trajectory.samples.size() == rows) break;
    rows = refused.trajectory.samples.size();
  }
  return published;
}

std::vector<double> segment_ends(const std::vector<double>& durations) {
  std::vector<double> ends;
  std::partial_sum(durations.begin(), durations.end(), std::back_inserter(ends));
  return ends;
}

}  // namespace fjr
