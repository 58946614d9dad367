// Certificates computed on several threads, and parts of certificates.
#pragma once

#include <vector>

#include "common/parallel.h"
#include "planner/certificate/certificate.h"

namespace fjr {

// Does the same as certify(), with its independent rollouts done by for_each; the certificate is the same.
Certificate certify(const Parameters& robot, const Limits& limits, const Trajectory& trajectory,
                    const ForEach& for_each);

// Judges the closed loop alone, for receivers that do not trust the sender of a trajectory. The open loop and perturbed
// starts are not rolled out. Rows that break a limit, or whose columns do not belong together, are not rolled out at
// all. The rollout has the accuracy of a prediction, 1e-7 rad, which takes half of the time. If it fails, one with the
// accuracy of a certificate decides, so that trajectories certified by certify() never fail.
Certificate judge_closed_loop(const Parameters& robot, const Limits& limits, const Trajectory& trajectory);

// Returns the local error of every interval, for mesh refinement. The exact model is integrated from the plan's own
// state at times[k] to times[k+1] under the published torque; the error is the state difference there (rollout minus
// plan). times: increasing, within the trajectory. Where the integration breaks down the difference is infinite.
std::vector<State<double>> local_errors(const Parameters& robot, const Trajectory& trajectory,
                                        const std::vector<double>& times);

}  // namespace fjr
