// Computes the margin that every limit needs because the arm's parameters are uncertain, and whether the motion has it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/not_stopped.h"
#include "common/parallel.h"
#include "planner/certificate/certificate.h"
#include "planner/certificate/task_of_motion.h"

namespace fjr {

inline constexpr double kCertainty = 0.95;  // confidence level of the fraction of arms that is found by draws

// Number of arms to draw, and how many of them may leave their tubes, for a certain fraction of all arms.
struct Draws {
  std::size_t arms, outside;
};
Draws draws_for(double confidence);

// Finds tubes such that at least the fraction `confidence` of the possible arms stays within them from the first row to
// the last, and judges whether limits and task are kept within the tubes. Limits: finite ones, with the feedback that
// the executor adds (QuantityInfo::with_feedback). A tube is a factor times the standard deviation over time of a
// deviation from the plan, by first-order sensitivities, and the effect of encoder counts. The factor is found by
// rolling out arms drawn from the covariance with the executor's own law (docs/theory.md). seed: of the draws.
// for_each: some hundred rollouts. stopped: asked before each of them, on several threads; what is stopped is not
// evaluated. Throws InputError if nothing is uncertain.
Robustness robustness(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                      const Trajectory& trajectory, double confidence, const ForEach& for_each = one_after_another,
                      const std::function<bool()>& stopped = not_stopped, std::uint64_t seed = 1);

// Demands robustness of a certificate: if a margin is missing, the trajectory is no longer certified, and a failure
// says why.
void demand_robustness(const Parameters& robot, const Limits& limits, const TaskOfMotion& task,
                       const Trajectory& trajectory, double confidence, Certificate& certificate,
                       const ForEach& for_each = one_after_another);

// Result of one arm rolled out with the executor's law: whether it keeps all limits and the task with feedback at the
// ends of all ticks, and how far its links are off the plan. Used to test what robustness() promises.
struct Trial {
  bool kept = false;
  Joints<double> link{};  // [rad] largest
};
Trial try_arm(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& trajectory,
              const Parameters& arm);

}  // namespace fjr
