// Compares the limits with the published rows and their interpolation, and with the closed-loop rollout.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planner/certificate/comparison.h"
#include "planner/certificate/thresholds.h"

namespace fjr {

// Returns one check per finite limit and joint. If a quantity is a polynomial between rows (QuantityInfo::degree), its
// extremes are found exactly; otherwise it is sampled every 0.25 ms. du/dt is the difference quotient of u = tau_m -
// tau_fm_nonlinear(dtheta) over each_pair_for_torque_rates(): at a torque jump tau_m steps with the friction and u does
// not.
std::vector<LimitCheck> check_limits(const Parameters& p, const Limits& limits, const Trajectory& trajectory,
                                     const Comparison& rollout);

// Visits the pairs of rows whose difference quotients are the rates of the torque. Calls visit(earlier, later) with the
// indices of all pairs that are at least kTorqueRateSpan and less than twice that apart, and of each row with the last
// one before it that is farther away. If all rows together take less time, the pair is the first and the last. (The
// mean over more time is no larger than the largest of these.)
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

// Returns what the rollout may reach: the limit plus what the exactness tolerance explains; no limit on what is a
// property of the plan alone.
Limits rollout_allowance(const Parameters& p, const Limits& limits);

// Returns ", both counted from 0.1" if the limit and the reached value are not counted from zero; else an empty string.
std::string counted_from(const LimitCheck& check, const Limits& limits);

// Returns a sentence for a check that did not pass. limits: those it was judged by; without them values count from
// zero.
std::string violation(const LimitCheck& check, const Limits& limits = {});

}  // namespace fjr
