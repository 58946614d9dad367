// The interface to the drives. The virtual arm is its first implementation; that of a real machine replaces it.
#pragma once

#include "model/parameters.h"

namespace fjr {

class Arm {
 public:
  virtual ~Arm() = default;

  virtual Pair<double> motor_positions() const = 0;  // [rad] in link coordinates, as the encoders count
  virtual Pair<double> link_positions() const = 0;   // [rad]

  // The torque of the coming tick [N m], in link coordinates; held until the next call.
  virtual void command(const Pair<double>& torque) = 0;
};

}  // namespace fjr
