// Simulates a trajectory on an arm that may differ from the one it was planned for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/trajectory/trajectory.h"

namespace fjr {

enum class ControlMode {
  kOpenLoop,    // the planned torque alone
  kClosedLoop,  // with motor-side feedback on the exact state, as in the certificate
  kExecutor,    // with the executor's law: encoder counts, torque held for 1 ms ticks, the drives' peak torque
};

struct Simulation {
  std::vector<Sample> samples;  // torque: as commanded, feedback included; of kExecutor the one held until the sample
  bool torque_held = false;     // until each sample, and not linear between them
  bool completed = false;
  std::string failure;  // why the integration broke down; empty when completed
};

// Rolls the trajectory out, with the accuracy of a certificate or (kExecutor) tick by tick with that of a prediction.
// planned_for: has the gains, encoders and drives; arm: the one that moves. The samples are at the instants of the
// certificate, at most 0.25 ms apart, or for kExecutor at the ends of its ticks.
// hold: [s] for which the executor's law then holds the arm in the rest at the last row's q (hold_at_rest), with a
// sample at the end of each tick; for learnt rows the motors are held at the last row's theta. 0 in open loop.
Simulation simulate(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory,
                    ControlMode control, double hold = 0);

// Returns the state in which a trajectory begins on that arm: its first row's or, if that is a rest of the arm it was
// planned for, the rest of the other arm. For learnt rows the motors keep their position, and the links hang from it.
State<double> start_on(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory);

// Returns whether that row is a rest of the arm that the trajectory was planned for or, for learnt rows, of the arm
// that they were learnt on: then it has no velocity.
bool stands(const Parameters& planned_for, const Trajectory& trajectory, const Sample& row);

// Returns what the executor holds after the end: the rest at the last row's q or, for learnt rows, the motors where
// they have them, with the torque of the springs. Returns nothing if the last row does not stand.
std::optional<Sample> held_after(const Parameters& planned_for, const Trajectory& trajectory);

}  // namespace fjr
