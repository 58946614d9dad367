// What a motion will tell of an arm's parameters, before it is executed.
#pragma once

#include <Eigen/Core>

#include "planner/identify/prior.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Fisher's information of the prior's independent numbers in what the executor will log of this motion on the arm
// known, as information_of() has it afterwards: encoders with their counts for noise, torques known, and pieces that
// begin anyhow. By the variational equation along the plan, tick by tick; 0 where the motors hardly move. n x n.
Eigen::MatrixXd planned_information(const Parameters& known, const Prior& prior, const Trajectory& plan);

}  // namespace fjr
