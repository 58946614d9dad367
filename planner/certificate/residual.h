// Motion of the arm after the end of a trajectory that ends at rest.
#pragma once

#include <functional>

#include "planner/certificate/certificate.h"

namespace fjr {

// Returns whether the row is an equilibrium: dq = dtheta = 0 and theta = q + K^-1 G(q), to 1e-5 rad and rad/s.
bool is_at_rest(const Parameters& p, const Sample& row);

// Returns the q [rad] at which the links rest when the motors stand at theta: theta = q + K^-1 G(q), by iteration.
Joints<double> resting_with(const Parameters& p, const Joints<double>& theta);

// Is called after every tick with the time [s] since the beginning, the state, and the torque commanded for the tick.
using HoldObserver = std::function<void(double time, const State<double>& x, const Joints<double>& torque)>;

// Holds the arm in the rest at `goal` for `duration` [s], beginning in the state `from`, by the executor's feedback
// with its ticks, dither and the counts of the encoders. Returns false if the integration broke down. moved: the
// arm that moves, if it differs from the one that gains and rest belong to.
bool hold_at_rest(const Parameters& p, const Sample& goal, const State<double>& from, double duration,
                  const HoldObserver& observe);
bool hold_at_rest(const Parameters& p, const Parameters& moved, const Sample& goal, const State<double>& from,
                  double duration, const HoldObserver& observe);

// Does the same at a place that need not be a rest for these parameters: with the motors at the place's theta, the
// links expected at its q, and its torque.
bool hold_at_place(const Parameters& p, const Parameters& moved, const Sample& place, const State<double>& from,
                   double duration, const HoldObserver& observe);

inline constexpr double kResidualWindow = 1;  // [s] after the end

// Returns the largest distance [rad] of the links from the rest at `goal` while they are held there for that time,
// beginning in the state `from`. Infinite if the integration broke down.
Joints<double> deviation_at_rest(const Parameters& p, const Sample& goal, const State<double>& from);

// Does the same with the torque that holds the rest, and without feedback. If the integration breaks down, the drift
// reached so far is returned. [rad]
Joints<double> drift_at_rest(const Parameters& p, const Sample& goal, const State<double>& from);

}  // namespace fjr
