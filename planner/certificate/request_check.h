// Checks that a trajectory is the motion that was requested. A certificate by itself is only about a trajectory and a
// robot.
#pragma once

#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Compares the published rows, with their interpolation, with start, goal, via points and task of the request. Fills
// certificate.task, adds a failure for each one that is missed, and withdraws the certificate then. ends: [s] when the
// motion's segments end, one per segment.
void check_against_request(const Problem& problem, const std::vector<double>& ends, const Trajectory& trajectory,
                           Certificate& certificate);

// Checks the task alone: fills certificate.task, adds a failure for each constraint that is missed, and withdraws the
// certificate then. ends: [s] as above; if it is empty nothing is checked.
void check_against_task(const Parameters& robot, const Task& task, const std::vector<double>& ends,
                        const Trajectory& trajectory, Certificate& certificate);

}  // namespace fjr
