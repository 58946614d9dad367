// The interface to the drives and encoders: what has to be written for a real machine. The virtual arm is its first
// implementation. The executor's control tick calls, every kTick (1 ms) and always in this order,
//
//   read(ticks) what the encoders say now, at the beginning of the tick
//   command()   the torque from now to the next tick
//
// from one thread of real-time priority. Neither may wait, allocate or take longer than a small part of the tick: a
// field bus is to be polled by a thread or device of its own, with its latest values at hand here.
//
// Signs and units. Joint 1 first. q = 0 hangs straight down, positive counter-clockwise as seen by the plane of motion
// (x to the right, y up); q2 is relative to link 1. Motor positions and torques are in link coordinates, after the
// gear: theta = motor angle / ratio, torque = motor torque x ratio, both positive in the direction of q. At rest theta
// = q + K^-1 G(q); with the arm hanging still all four positions are zero. Positive torque must make theta grow.
//
// Samples that do not arrive are left out of the Reading, never repeated and never zero. Up to kLostAfter in a row are
// bridged by the plan; then the encoder counts as lost, the arm is stopped without feedback on its joint and held.
//
// When the ticks themselves do not come, the last torque holds for up to kStallTicks missed ones. By then the drives
// must brake by themselves: when the executor is back, it gives up the motion, and brings the arm to rest from where it
// finds it.
// An exception from either call ends the program: an arm must then come to rest by what is not software.
#pragma once

#include <optional>

#include "model/parameters.h"

namespace fjr {

struct Reading {
  Joints<std::optional<double>> theta;  // [rad] of the motors, in link coordinates
  Joints<std::optional<double>> q;      // [rad] of the links
};

inline constexpr int kStallTicks = 5;  // missed in a row that the plan bridges

class Arm {
 public:
  virtual ~Arm() = default;

  // ticks: since the call before by the executor's clock; 0 before the control starts, more than 1 when some were
  // missed.
  virtual Reading read(int ticks) = 0;

  // [N m] in link coordinates, within the drives' peak torque; to be held until the next call. When calls stop coming
  // (the program ended, or hangs) the drives must brake by themselves, within kStallTicks.
  virtual void command(const Joints<double>& torque) = 0;
};

}  // namespace fjr
