#include "planner/search/acceleration_penalty.h"

#include <cmath>
#include <utility>

#include "planner/search/continuation.h"
#include "planner/search/publication.h"

namespace fjr {
namespace {

bool leaves_torques_free(const Weights& weights) {
  return !settles_torque(weights) && !has_reward(weights) && !only_time(weights) && weights.link_acceleration == 0 &&
         weights.link_jerk == 0;
}

// Returns the integral [rad^2/s^3] of squared link accelerations of a minimum-jerk motion of this duration [s] that
// stops at every via point and takes the same time for each part: 120/7 d^2/T^3 for the distance d in the time T.
double smooth_acceleration(const Problem& problem, double duration) {
  const double part = duration / static_cast<double>(problem.via.size() + 1);
  double squares = 0;
  Joints<double> from = problem.start.q;
  const auto go_to = [&](const Joints<double>& to) {
    for (std::size_t j = 0; j < kJoints; ++j) squares += std::pow(to[j] - from[j], 2);
    from = to;
  };
  for (const Via& via : problem.via) go_to(via.q);
  go_to(problem.goal.q);
  return 120.0 / 7 * squares / std::pow(part, 3);
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

std::shared_ptr<const Problem> with_damping(const Problem& problem, double objective, double duration,
                                            const AccelerationPenaltySettings& settings) {
  const Weights& weights = problem.weights;
  if (!sees_friction(weights) || has_reward(weights) || duration < settings.time_to_oscillate) return nullptr;
  const double acceleration = smooth_acceleration(problem, duration);
  if (!(objective > 0 && acceleration > 0)) return nullptr;
  const double weight = settings.part_of_objective * objective / acceleration;
  return with_weights(problem, weights.link_acceleration + weight, weights.link_jerk);
}

void fade_acceleration_penalty(Findings& found, Session& session) {
  if (!found.certified() || only_time(found.asked.weights)) return;
  const double asked = found.asked.weights.link_acceleration / found.scale;
  const auto more = [&] { return found.best->problem->weights.link_acceleration - asked; };
  const AccelerationPenaltySettings& s = session.settings().acceleration_penalty;
  double factor = more() > s.weight ? s.damping_factor : s.less;
  for (int step = 0; step < s.steps && more() > 0 && !session.interrupted(); ++step) {
    const Problem& best = *found.best->problem;
    Continuation c(with_weights(best, asked + factor * more(), best.weights.link_jerk), session,
                   "with less acceleration penalty");
    const double objective = found.best->objective;
    if (c.resume(Collocated(found.best->solution)) == ResumeOutcome::kSolved) {
      found.keep(c, publish(c, found.asked, session));
    }
    const bool better = found.best->objective < objective;
    if (!better && std::exchange(factor, s.less) == s.less) return;
  }
}

}  // namespace fjr
