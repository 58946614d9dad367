// The limits, held against the published rows with their interpolation and against the closed-loop rollout.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planner/certificate/comparison.h"

namespace fjr {

// One check per finite limit and joint. What is a polynomial between rows (QuantityInfo::degree) is searched for its
// extremes exactly, anything else is sampled every 0.25 ms. du/dt is the difference quotient
// of u = tau_m - tau_fm_nonlinear(dtheta) over pairs_for_torque_rates(): at a torque jump tau_m steps
// with the friction and u does not.
std::vector<LimitCheck> check_limits(const Parameters& p, const Limits& limits, const Trajectory& trajectory,
                                     const Comparison& rollout);

// Over less time than this a rate of the torque is not judged: half a tick of the executor, which commands means of the
// torque over whole ticks. Rows are published closer to each other where the torque has a corner. [s]
inline constexpr double kTorqueRateSpan = 0.5e-3;

// Rates of the torque are difference quotients of two rows, an earlier and a later one, by their indices: of all rows
// that are at least kTorqueRateSpan and less than twice that apart, and of each row and the last one before it that is
// farther away. Over more time a mean is no larger than the largest of these. A torque that swings faster is seen
// wherever it has changed by more than the limit allows within kTorqueRateSpan.
struct RowPair {
  std::size_t earlier, later;
};
std::vector<RowPair> pairs_for_torque_rates(const std::vector<Sample>& rows);

// What the rollout may reach: more than the limit only by what the exactness explains.
Limits rollout_allowance(const Parameters& p, const Limits& limits);

// ", both counted from 0.1" where the limit and what is reached of it are not counted from zero; else empty.
std::string counted_from(const LimitCheck& check, const Limits& limits);

// One sentence for a check that did not pass. limits: that it was judged by; without them all is counted from zero.
std::string violation(const LimitCheck& check, const Limits& limits = {});

}  // namespace fjr
