// What one executed motion tells of an arm's parameters.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "common/not_stopped.h"
#include "common/parallel.h"
#include "planner/identify/prior.h"
#include "planner/identify/replay.h"

namespace fjr {

// About the arm known, to first order, and whatever the motion began with: the log likelihood of its readings is, but
// for a constant, z' score - z' matrix z / 2, where the parameters are off by the prior's factor times z.
struct MotionInformation {
  Eigen::MatrixXd matrix;  // Fisher's information of z, with the encoders' counts for noise; n x n
  Eigen::VectorXd score;   // n
  double chi_square = 0;   // per degree of freedom: what is left of the readings that no z explains
  long readings = 0;
};

// Nothing where the motors hardly move, or where the arm known cannot be rolled out under the torques of the motion.
// for_each: 2 n + 50 rollouts. stopped: asked before each of them; then there is nothing.
std::optional<MotionInformation> information_of(const Parameters& known, const Prior& prior,
                                                const ExecutedMotion& motion,
                                                const ForEach& for_each = one_after_another,
                                                const std::function<bool()>& stopped = not_stopped);

}  // namespace fjr
