// The interface to the drives and encoders: what has to be written for a real machine. The virtual arm is its first
// implementation. The executor's control tick calls, every kTick (1 ms) and always in this order,
//
//   read()      what the encoders say now, at the beginning of the tick
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
// bridged by the plan; then the encoder counts as lost, the arm is stopped without feedback on its joint and held. An
// exception from either call ends the program: an arm must then come to rest by what is not software.
#pragma once

#include <optional>

#include "model/parameters.h"

namespace fjr {

struct Reading {
  Pair<std::optional<double>> theta;  // [rad] of the motors, in link coordinates
  Pair<std::optional<double>> q;      // [rad] of the links
  int ticks = 1;  // since the reading before, by the machine's clock: more than 1 says that ticks were missed
};

class Arm {
 public:
  virtual ~Arm() = default;

  virtual Reading read() = 0;

  // [N m] in link coordinates, within the drives' peak torque; to be held until the next call. When calls stop coming
  // (the program ended, or hangs) the drives must brake or switch off by themselves, within a few ticks.
  virtual void command(const Pair<double>& torque) = 0;
};

}  // namespace fjr
