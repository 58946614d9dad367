// The executor's ticks along a trajectory, on the simulated arm.
#pragma once

#include <functional>

#include "model/dynamics.h"
#include "planner/control/motor_feedback.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// One tick of the executor on the simulated arm.
struct SimulatedTick {
  double end = 0;  // [s]
  TickController::Command command;
  State<double> state;  // at its end
};

// Ticks until the trajectory ends; the last may be shorter.
long tick_count(const Trajectory& trajectory);

// Rolls the ticks out from `start` until the trajectory ends. Returns false if the integration broke down.
bool roll_out_ticks(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory,
                    const State<double>& start, const std::function<void(const SimulatedTick&)>& observe);

}  // namespace fjr
