// The limits, held against the published rows with their interpolation and against the closed-loop rollout.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "planner/certificate/comparison.h"

namespace fjr {

// One check per finite limit and joint. What is a polynomial between rows (QuantityInfo::degree) is searched for its
// extremes exactly, anything else is sampled every 0.25 ms. du/dt is the difference quotient
// of u = tau_m - tau_fm_nonlinear(dtheta) over rows_of_torque_rates(): at a torque jump tau_m steps
// with the friction and u does not.
std::vector<LimitCheck> check_limits(const Parameters& p, const Limits& limits, const Trajectory& trajectory,
                                     const Comparison& rollout);

// Rates of the torque are difference quotients of rows: that at row k, k > 0, is taken since the row with this index.
// None where the rows before it take too little time. The rows are at least half as far apart as the rows about them,
// within 5 ms, the longest sample period, are at most: rows are published close to each other where the torque has a
// corner, and a quotient of two such rows is not what a drive is asked for.
std::vector<std::optional<std::size_t>> rows_of_torque_rates(const std::vector<Sample>& rows);

// What the rollout may reach: more than the limit only by what the exactness explains.
Limits rollout_allowance(const Parameters& p, const Limits& limits);

// ", both counted from 0.1" where the limit and what is reached of it are not counted from zero; else empty.
std::string counted_from(const LimitCheck& check, const Limits& limits);

// One sentence for a check that did not pass. limits: that it was judged by; without them all is counted from zero.
std::string violation(const LimitCheck& check, const Limits& limits = {});

}  // namespace fjr
