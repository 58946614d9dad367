// What the arm does after the end of a trajectory that ends at rest.
#pragma once

#include <functional>

#include "planner/certificate/certificate.h"

namespace fjr {

// The row is an equilibrium: dq = dtheta = 0 and theta = q + K^-1 G(q), to 1e-5 rad and rad/s.
bool is_at_rest(const Parameters& p, const Sample& row);

// q in which the links hang still when the motors stand at theta: theta = q + K^-1 G(q), by iteration. [rad]
Joints<double> resting_with(const Parameters& p, const Joints<double>& theta);

// Holds the arm from `from` at the rest at `goal`, by the executor's feedback with its ticks, dither and the counts of
// the encoders, for `duration`. [s] After every tick observe is called with the time since the beginning, the state
// reached, and the torque that was commanded for the tick. False when the integration broke down.
// `moved`: the arm that moves, where it is not the one that gains and rest are for.
using HoldObserver = std::function<void(double time, const State<double>& x, const Joints<double>& torque)>;
bool hold_at_rest(const Parameters& p, const Sample& goal, const State<double>& from, double duration,
                  const HoldObserver& observe);
bool hold_at_rest(const Parameters& p, const Parameters& moved, const Sample& goal, const State<double>& from,
                  double duration, const HoldObserver& observe);

// The same at a place that need be no rest for these parameters: with the motors at the place's theta, the links
// expected at its q, and its torque.
bool hold_at_place(const Parameters& p, const Parameters& moved, const Sample& place, const State<double>& from,
                   double duration, const HoldObserver& observe);

inline constexpr double kResidualWindow = 1;  // [s] after the end

// How far the links come off the rest at `goal` within that time, held there from `from` on. Infinite where the
// integration broke down. [rad]
Joints<double> deviation_at_rest(const Parameters& p, const Sample& goal, const State<double>& from);

// The same with the torque that holds the rest, and without feedback. A breakdown of the integration leaves the drift
// reached so far. [rad]
Joints<double> drift_at_rest(const Parameters& p, const Sample& goal, const State<double>& from);

}  // namespace fjr
