// The interface to the drives and encoders, which has to be implemented for a real machine. VirtualArm implements it by
// simulation. The executor's control tick calls, every kTick (1 ms) and always in this order,
//
//   read(ticks) to read the encoders at the beginning of the tick
//   command()   to set the torque until the next tick
//
// from one thread of real-time priority. Neither may wait, allocate or take longer than a small part of the tick. A
// field bus should therefore be polled by a thread or device of its own, so that its latest values are available here.
//
// Signs and units. Joint 1 first. q = 0 hangs straight down, positive counter-clockwise as seen by the plane of motion
// (x to the right, y up); q2 is relative to link 1. Motor positions and torques are in link coordinates, after the
// gear: theta = motor angle / ratio, torque = motor torque x ratio, both positive in the direction of q. At rest theta
// = q + K^-1 G(q); with the arm hanging still all four positions are zero. Positive torque must make theta grow.
//
// Samples that do not arrive must be left out of the Reading; they must not be repeated or set to zero. The executor
// replaces up to kLostAfter missing samples in a row by planned values. After that the encoder counts as lost: the arm
// is stopped without feedback on that joint, and held.
//
// If ticks are missed, the last torque holds for up to kStallTicks of them. After that the drives must brake by
// themselves. When the executor runs again, it aborts the motion and brings the arm to rest from where it is. An
// exception from either call ends the program. The arm must then come to rest by means other than software.
#pragma once

#include <optional>

#include "model/parameters.h"

namespace fjr {

struct Reading {
  Joints<std::optional<double>> theta;  // [rad] of the motors, in link coordinates
  Joints<std::optional<double>> q;      // [rad] of the links
};

inline constexpr int kStallTicks = 5;  // missed ticks in a row after which a motion still continues

class Arm {
 public:
  virtual ~Arm() = default;

  // Reads the encoders. ticks: number of ticks since the previous call by the executor's clock; 0 before the control
  // starts, more than 1 if some were missed.
  virtual Reading read(int ticks) = 0;

  // Sets the torque [N m] in link coordinates, within the drives' peak torque, which must be held until the next call.
  // When calls stop coming (the program has ended or hangs), the drives must brake by themselves within kStallTicks.
  virtual void command(const Joints<double>& torque) = 0;
};

}  // namespace fjr
