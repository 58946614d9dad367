// Compares the limits with the published rows and their interpolation, and with the closed-loop rollout.
#pragma once

#include <algorithm>
#include <array>
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

// An instant between row `row` and the next one.
struct BetweenRows {
  std::size_t row;
  double time;  // [s]
};

// Visits the pairs of instants whose difference quotients are the rates of the torque. Between rows u counts as linear.
// No other two instants from kTorqueRateSpan to twice that apart have a larger mean rate than the largest of these: all
// pairs of rows that are that far apart, and of every row the instants at either of these distances before and after
// it. If all rows together take less time, the pair is the first and the last. Calls visit(earlier, later).
template <class Visit>
void each_pair_for_torque_rates(const std::vector<Sample>& rows, const Visit& visit) {
  const double begin = rows.front().time, end = rows.back().time;
  const std::size_t last = rows.size() - 2;  // the last row that another one follows
  const auto row = [&](std::size_t k) { return BetweenRows{std::min(k, last), rows[k].time}; };
  if (end - begin <= kTorqueRateSpan) return visit(row(0), row(last + 1));
  std::size_t far = 0, near = 0;    // the first rows that are less than twice the span, and less than the span, away
  std::array<std::size_t, 4> at{};  // the rows before the instants beside a row, which move on with it
  const auto beside = [&](std::size_t which, double time) {
    while (at[which] < last && rows[at[which] + 1].time <= time) ++at[which];
    return BetweenRows{at[which], time};
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double time = rows[k].time;
    while (time - rows[far].time >= 2 * kTorqueRateSpan) ++far;
    while (time - rows[near].time >= kTorqueRateSpan) ++near;
    for (std::size_t i = far; i < near; ++i) visit(row(i), row(k));
    std::size_t which = 0;
    for (const double span : {kTorqueRateSpan, 2 * kTorqueRateSpan}) {
      if (time - span >= begin) visit(beside(which, time - span), row(k));
      if (time + span <= end) visit(row(k), beside(which + 1, time + span));
      which += 2;
    }
  }
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
