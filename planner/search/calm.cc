#include "planner/search/calm.h"

#include <utility>

#include "planner/search/continuation.h"
#include "planner/search/publication.h"

namespace fjr {
namespace {

constexpr double kSwingingTime = 2;  // [s] least duration in which a motion has time to spare
// [s^4/rad^2], of an objective that was divided by its size. Energy in 3 to 8 s comes to 0.1 % more with it, a peak
// torque in 5 s to less than with ten times as much, from which it did not come down.
constexpr double kWeight = 1e-4;
constexpr double kLess = 0.3;  // times the last weight, as often as below: then it costs less than 0.02 %
constexpr int kSteps = 5;

bool leaves_torques_free(const Weights& weights) {
  return !settles_torque(weights) && !has_reward(weights) && !only_time(weights) && weights.link_acceleration == 0 &&
         weights.link_jerk == 0;
}

std::shared_ptr<const Problem> with_weight(Problem problem, double weight) {
  problem.weights.link_acceleration = weight;
  return std::make_shared<const Problem>(std::move(problem));
}

}  // namespace

std::shared_ptr<const Problem> calmed(const Problem& problem) {
  if (!leaves_torques_free(problem.weights) || problem.duration.min < kSwingingTime) return nullptr;
  return with_weight(problem, kWeight);
}

void take_calm_back(Findings& found, Session& session) {
  if (!found.certified() || !leaves_torques_free(found.asked.weights)) return;
  for (int step = 0; step < kSteps && !session.interrupted(); ++step) {
    const Publication& best = *found.best;
    const double weight = best.problem->weights.link_acceleration, objective = best.objective;
    if (weight == 0) return;
    Continuation c(with_weight(*best.problem, kLess * weight), session, "less calm");
    if (!c.resume(Collocated(best.solution))) return;
    found.keep(c, publish(c, found.asked, session));
    if (!(found.best->objective < objective)) return;
  }
}

}  // namespace fjr
