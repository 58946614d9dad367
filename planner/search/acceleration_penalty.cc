#include "planner/search/acceleration_penalty.h"

#include <utility>

#include "planner/search/continuation.h"
#include "planner/search/publication.h"

namespace fjr {
namespace {

bool leaves_torques_free(const Weights& weights) {
  return !settles_torque(weights) && !has_reward(weights) && !only_time(weights) && weights.link_acceleration == 0 &&
         weights.link_jerk == 0;
}

std::shared_ptr<const Problem> with_weights(Problem problem, double link_acceleration, double link_jerk = 0) {
  problem.weights.link_acceleration = link_acceleration;
  problem.weights.link_jerk = link_jerk;
  return std::make_shared<const Problem>(std::move(problem));
}

}  // namespace

std::vector<std::shared_ptr<const Problem>> fastest_with_acceleration_penalties(
    const Problem& problem, const AccelerationPenaltySettings& settings) {
  const double acceleration = settings.fastest_acceleration, jerk = settings.fastest_jerk;
  return {with_weights(problem, acceleration, jerk), with_weights(problem, acceleration, jerk / settings.less_jerk),
          with_weights(problem, acceleration)};
}

std::shared_ptr<const Problem> with_acceleration_penalty(const Problem& problem,
                                                         const AccelerationPenaltySettings& settings) {
  if (!leaves_torques_free(problem.weights) || problem.duration.min < settings.time_to_oscillate) return nullptr;
  return with_weights(problem, settings.weight);
}

void fade_acceleration_penalty(Findings& found, Session& session) {
  if (!found.certified() || !leaves_torques_free(found.asked.weights)) return;
  const AccelerationPenaltySettings& s = session.settings().acceleration_penalty;
  for (int step = 0; step < s.steps && !session.interrupted(); ++step) {
    const Publication& best = *found.best;
    const double weight = best.problem->weights.link_acceleration, objective = best.objective;
    if (weight == 0) return;
    Continuation c(with_weights(*best.problem, s.less * weight), session, "with less acceleration penalty");
    if (c.resume(Collocated(best.solution)) != ResumeOutcome::kSolved) return;
    found.keep(c, publish(c, found.asked, session));
    if (!(found.best->objective < objective)) return;
  }
}

}  // namespace fjr
