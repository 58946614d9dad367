// The information about an arm's parameters in one executed motion.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "common/not_stopped.h"
#include "common/parallel.h"
#include "planner/identify/prior.h"
#include "planner/identify/replay.h"

namespace fjr {

// The log likelihood of the readings, linearised at the known arm and maximised over the initial states, is up to a
// constant z' score - z' matrix z / 2. z are the prior's independent numbers: the parameter errors are factor * z.
struct MotionInformation {
  Eigen::MatrixXd matrix;  // Fisher information of z, with quantisation of the encoders as noise; n x n
  Eigen::VectorXd score;   // n
  double chi_square = 0;   // per degree of freedom, of the residuals that no z explains
  long readings = 0;
};

// Returns nothing if the motors hardly move, if the known arm cannot be simulated under the torques of the motion, or
// once stopped() is true, which is called before every rollout. for_each runs 2 n + 50 rollouts.
std::optional<MotionInformation> information_of(const Parameters& known, const Prior& prior,
                                                const ExecutedMotion& motion,
                                                const ForEach& for_each = one_after_another,
                                                const std::function<bool()>& stopped = not_stopped);

}  // namespace fjr
