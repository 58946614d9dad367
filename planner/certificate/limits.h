// The limits, held against the published rows with their interpolation and against the closed-loop rollout.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planner/certificate/comparison.h"
#include "planner/certificate/thresholds.h"

namespace fjr {

// One check per finite limit and joint. What is a polynomial between rows (QuantityInfo::degree) is searched for its
// extremes exactly, anything else is sampled every 0.25 ms. du/dt is the difference quotient
// of u = tau_m - tau_fm_nonlinear(dtheta) over each_pair_for_torque_rates(): at a torque jump tau_m steps
// with the friction and u does not.
std::vector<LimitCheck> check_limits(const Parameters& p, const Limits& limits, const Trajectory& trajectory,
                                     const Comparison& rollout);

// Rates of the torque are difference quotients of two rows. Calls visit(earlier, later) with the indices of all that
// are at least kTorqueRateSpan and less than twice that apart, and of each row with the last one before it that is
// farther away; of rows that take less time in all, with the first and the last. (The mean over more time is no larger
// than the largest of these.)
template <class Visit>
void each_pair_for_torque_rates(const std::vector<Sample>& rows, const Visit& visit) {
  std::size_t far = 0, near = 0;  // the first rows that are less than twice the span, and less than the span, away
  for (std::size_t k = 1; k < rows.size(); ++k) {
    while (rows[k].time - rows[far].time >= 2 * kTorqueRateSpan) ++far;
    while (rows[k].time - rows[near].time >= kTorqueRateSpan) ++near;
    if (far > 0) visit(far - 1, k);
    for (std::size_t i = far; i < near; ++i) visit(i, k);
  }
  if (near == 0) visit(std::size_t{0}, rows.size() - 1);
}

// What the rollout may reach: more than the limit only by what the exactness explains.
Limits rollout_allowance(const Parameters& p, const Limits& limits);

// ", both counted from 0.1" where the limit and what is reached of it are not counted from zero; else empty.
std::string counted_from(const LimitCheck& check, const Limits& limits);

// One sentence for a check that did not pass. limits: that it was judged by; without them all is counted from zero.
std::string violation(const LimitCheck& check, const Limits& limits = {});

}  // namespace fjr
