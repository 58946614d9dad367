// What the uncertainty of the arm's parameters makes of a motion: the margin that every limit needs, and whether it is
// there.
#pragma once

#include <cstdint>
#include <vector>

#include "common/parallel.h"
#include "planner/certificate/certificate.h"
#include "planner/certificate/task_of_motion.h"

namespace fjr {

inline constexpr double kCertainty = 0.95;  // with which the fraction of arms is found by draws

// How many arms have to be drawn, and how many of them may leave their tubes, to be certain of a fraction.
struct Draws {
  std::size_t arms, outside;
};
Draws draws_for(double confidence);

// Of the arms that the robot's uncertainty leaves possible, at least the fraction `confidence` keeps all limits and the
// task, and stays within the tubes told, from the first row to the last. Limits: finite ones, with the feedback that
// the executor adds (QuantityInfo::with_feedback). Tubes are a factor times the standard deviation of each deviation
// from the plan over time, by first-order sensitivities, and what encoder counts make; the factor is found by rolling
// out arms drawn from the covariance with the executor's own law (docs/theory.md). seed: of the draws.
// for_each: some hundred rollouts. Throws InputError where nothing is uncertain.
Robustness robustness(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                      const Trajectory& trajectory, double confidence, const ForEach& for_each = one_after_another,
                      std::uint64_t seed = 1);

// Asks a certificate for that too: what is certified and lacks a margin is certified no longer, and says why.
void demand_robustness(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                       const Trajectory& trajectory, double confidence, Certificate& certificate,
                       const ForEach& for_each = one_after_another);

// One arm, rolled out with the executor's law: whether it keeps all limits and the task with feedback at the ends of
// all ticks, and how far its links are off the plan. For trials of what is promised.
struct Trial {
  bool kept = false;
  Joints<double> link{};  // [rad] largest
};
Trial try_arm(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& trajectory,
              const Parameters& arm);

}  // namespace fjr
