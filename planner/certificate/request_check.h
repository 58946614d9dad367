// A certificate is about a trajectory and a robot; that the trajectory is also the motion that was asked for is checked
// here.
#pragma once

#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Holds the published rows, with their interpolation, against start, goal, via points and task of the request. Fills
// certificate.task, adds a failure for whatever is missed, and withdraws the certificate then. ends: [s] when the
// motion's segments end, one per segment.
void check_against_request(const Problem& problem, const std::vector<double>& ends, const Trajectory& trajectory,
                           Certificate& certificate);

// Of that the task alone: fills certificate.task, adds a failure for each constraint that is missed, and withdraws the
// certificate then. ends: [s] as above; without any nothing is checked.
void check_against_task(const Parameters& robot, const Task& task, const std::vector<double>& ends,
                        const Trajectory& trajectory, Certificate& certificate);

}  // namespace fjr
