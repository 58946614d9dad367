// Predicts how much information a motion will contain about an arm's parameters.
#pragma once

#include <Eigen/Core>

#include "planner/identify/prior.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Returns the expected Fisher information (n x n) of the prior's independent numbers in the log of this motion on the
// known arm, as information_of() computes it afterwards: with quantisation of the encoders as noise, known torques, and
// unknown initial states of the pieces. It integrates the variational equation along the plan, tick by tick, and is 0
// if the motors hardly move.
Eigen::MatrixXd planned_information(const Parameters& known, const Prior& prior, const Trajectory& plan);

}  // namespace fjr
