#include "planner/search/acceleration_penalty.h"

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

std::shared_ptr<const Problem> with_weights(Problem problem, double link_acceleration, double link_jerk = 0) {
  problem.weights.link_acceleration = link_acceleration;
  problem.weights.link_jerk = link_jerk;
  return std::make_shared<const Problem>(std::move(problem));
}

}  // namespace

// The acceleration stills the springs: a motion of 30 s takes 0.2 % longer for it. The jerk stills the motors too,
// whose trembling the executor's feedback cannot follow where they turn back slowly; it costs another 0.05 %. Of ten
// motions of 6 to 75 s that a tip speed or motor velocities slow down, the first of these certified eight, the second
// another.
std::vector<std::shared_ptr<const Problem>> fastest_with_acceleration_penalties(const Problem& problem) {
  constexpr double kAcceleration = 0.01, kJerk = 1e-5;  // [s^4/rad^2], [s^6/rad^2]
  return {with_weights(problem, kAcceleration, kJerk), with_weights(problem, kAcceleration, kJerk / 10),
          with_weights(problem, kAcceleration)};
}

std::shared_ptr<const Problem> with_acceleration_penalty(const Problem& problem) {
  if (!leaves_torques_free(problem.weights) || problem.duration.min < kSwingingTime) return nullptr;
  return with_weights(problem, kWeight);
}

void fade_acceleration_penalty(Findings& found, Session& session) {
  if (!found.certified() || !leaves_torques_free(found.asked.weights)) return;
  for (int step = 0; step < kSteps && !session.interrupted(); ++step) {
    const Publication& best = *found.best;
    const double weight = best.problem->weights.link_acceleration, objective = best.objective;
    if (weight == 0) return;
    Continuation c(with_weights(*best.problem, kLess * weight), session, "less calm");
    if (!c.resume(Collocated(best.solution))) return;
    found.keep(c, publish(c, found.asked, session));
    if (!(found.best->objective < objective)) return;
  }
}

}  // namespace fjr
