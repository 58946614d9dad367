#include "planner/search/acceleration_penalty.h"

#include <utility>

#include "planner/search/continuation.h"
#include "planner/search/publication.h"

namespace fjr {
namespace {

constexpr double kSwingingTime = 2;  // [s] motions that last at least this long have time to oscillate
// [s^4/rad^2] weight in an objective that is divided by its size. Minimum-energy motions of 3 to 8 s need 0.1 % more
// energy with it. With ten times as much, the peak torque of a motion of 5 s was higher, and did not come down when the
// weight was reduced.
constexpr double kWeight = 1e-4;
constexpr double kLess = 0.3;  // factor on the weight in each step; after kSteps of them it costs less than 0.02 %
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

// The penalty on acceleration damps the springs; it makes a motion of 30 s 0.2 % longer. The penalty on jerk also damps
// the motors, because the executor's feedback cannot follow their oscillation where they reverse slowly; it costs
// another 0.05 %. Of ten motions of 6 to 75 s that are limited by the tip speed or motor velocities, the first variant
// certified eight and the second one another.
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
    Continuation c(with_weights(*best.problem, kLess * weight), session, "with less acceleration penalty");
    if (c.resume(Collocated(best.solution)) != ResumeOutcome::kSolved) return;
    found.keep(c, publish(c, found.asked, session));
    if (!(found.best->objective < objective)) return;
  }
}

}  // namespace fjr
