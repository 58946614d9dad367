// Certificates on several threads, and parts of them, for those who need one of these.
#pragma once

#include <vector>

#include "common/parallel.h"
#include "planner/certificate/certificate.h"

namespace fjr {

// certify() with the rollouts, which are independent of each other, done by for_each; the certificate is the same.
Certificate certify(const Parameters& robot, const Limits& limits, const Trajectory& trajectory,
                    const ForEach& for_each);

// The closed-loop half of the verdict, for those who receive a trajectory and believe nobody: neither the open loop is
// rolled out, nor what begins beside the start. Rows that break a limit, or whose columns do not belong together, are
// not rolled out at all. The rollout has the accuracy of a prediction, 1e-7 rad, which takes half of the time, and what
// fails in it is judged by one with the accuracy of a certificate: what certify() certifies never fails.
Certificate judge_closed_loop(const Parameters& robot, const Limits& limits, const Trajectory& trajectory);

// For mesh refinement: integrates the exact model from the plan's own state at times[k] to times[k+1] under the
// published torque and returns the state differences at times[k+1] (rollout minus plan), one per interval. times:
// increasing, within the trajectory. Where the integration breaks down the difference is infinite.
std::vector<State<double>> local_errors(const Parameters& robot, const Trajectory& trajectory,
                                        const std::vector<double>& times);

}  // namespace fjr
