// The virtual rig: the true arm and its measuring instruments.
#pragma once

#include <cstdint>

#include "model/parameters.h"

namespace fjr {

// Hysteresis of the springs: tau_c = K phi + height z, phi = theta - q, by the rate-independent Bouc-Wen model with n =
// 1 and beta = gamma, which is Dahl's:  dz/dt = (dphi/dt - z |dphi/dt|) / width. The height is an assumption, 1 % and
// 0.4 % of the largest torque of the stiffness experiment; Figs. 3 and 4 of the paper show a loop that is larger in
// joint 1 and print no number.
struct Hysteresis {
  Joints<double> height{0.08, 0.015};  // [N m]  half the opening of the loop
  Joints<double> width{0.01, 0.01};    // [rad]  deflection in which a reversal is forgotten to 1/e

  bool operator==(const Hysteresis&) const = default;
};

// Properties of the instruments. They are assumptions, except for the encoders.
struct Instruments {
  Joints<double> torque_noise{0.05, 0.02};      // [N m]    standard deviation of one sample
  Joints<double> velocity_noise{0.005, 0.005};  // [rad/s]  of the drive's own velocity
  bool encoders = true;                         // false: positions are measured without quantisation

  bool operator==(const Instruments&) const = default;
};

struct Rig {
  Parameters truth;
  Hysteresis hysteresis;
  Instruments instruments;
  std::uint64_t seed = 1;

  // Returns the rig of the paper's arm with link damping: 0.2516 N m s/rad follows from (11) and (13); 0.01 is an
  // assumption.
  static Rig of(const Parameters& robot) {
    Rig rig{robot, {}, {}, 1};
    rig.truth.link.damping = {0.2516, 0.01};
    return rig;
  }

  // Returns a rig without noise, quantisation and hysteresis.
  static Rig ideal(const Parameters& robot) {
    Rig rig = of(robot);
    rig.hysteresis.height = {0, 0};
    rig.instruments = {{0, 0}, {0, 0}, false};
    return rig;
  }

  bool noisy() const { return instruments.velocity_noise != Joints<double>{0, 0}; }
};

}  // namespace fjr
