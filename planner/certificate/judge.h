// The parts of a certificate, for those who need one of them.
#pragma once

#include <vector>

#include "common/parallel.h"
#include "planner/certificate/certificate.h"

namespace fjr {

// The verdict on one trajectory on one robot, without residual and tracking; `limits` are the robot's or tighter.
// for_each: the rollouts of the open and of the closed loop, and then five closed loops from beside the start.
Certificate judge(const Parameters& robot, const Limits& limits, const Trajectory& trajectory,
                  const ForEach& for_each = one_after_another);

// The closed-loop half of it, for those who receive a trajectory and believe nobody: neither the open loop is rolled
// out, nor what begins beside the start. Rows that break a limit, or whose columns do not belong together, are not
// rolled out at all. The rollout has the accuracy of a prediction, 1e-7 rad, which takes half of the time, and what
// fails in it is judged by one with the accuracy of a certificate: what judge() certifies never fails.
Certificate judge_closed_loop(const Parameters& robot, const Limits& limits, const Trajectory& trajectory);

// Adds residual and tracking, on which no verdict depends: half of the cost of a certificate, and for the trajectory
// that becomes the plan alone. A trajectory that ends with dq = dtheta = 0 in equilibrium is taken to end at rest.
// for_each: both of them.
void predict(const Parameters& robot, const Trajectory& trajectory, Certificate& certificate,
             const ForEach& for_each = one_after_another);

// For mesh refinement: integrates the exact model from the plan's own state at times[k] to times[k+1] under the
// published torque and returns the state differences at times[k+1] (rollout minus plan), one per interval. times:
// increasing, within the trajectory. Where the integration breaks down the difference is infinite.
std::vector<State<double>> local_errors(const Parameters& robot, const Trajectory& trajectory,
                                        const std::vector<double>& times);

}  // namespace fjr
