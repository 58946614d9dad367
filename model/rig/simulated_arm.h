// Simulates the arm on its rig by CVODE. Links may be free, clamped or removed; motors are driven in one of their
// modes.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "model/dynamics.h"
#include "model/rig/rig.h"

namespace fjr {

enum class LinkMount { kFree, kClamped, kRemoved };

struct MotorMotion {
  double theta, dtheta, ddtheta;  // [rad], [rad/s], [rad/s^2]
};

// The drive of one motor, with ideal inner loops. In interpolated position mode and velocity mode the motor follows the
// commanded motion exactly (`motion`); in torque mode the torque equals the commanded one (`torque`). Exactly one of
// them is set.
struct MotorDrive {
  std::function<MotorMotion(double time)> motion;
  std::function<double(double time, double dtheta)> torque;  // tau_m [N m]

  static MotorDrive still() {
    return {[](double) { return MotorMotion{0, 0, 0}; }, {}};
  }
};

struct Mounting {
  Joints<LinkMount> links{LinkMount::kFree, LinkMount::kFree};
  bool gravity = true;  // false: the arm lies parallel to the ground
  Joints<MotorDrive> drives{MotorDrive::still(), MotorDrive::still()};
  std::function<Joints<double>(double time)> push;  // [N m] external torque on the links; may be empty
};

// Integrates by Adams-Moulton with fixed-point iteration. The problem is not stiff, and BDF would add numerical damping
// to the oscillations whose decay is identified. It starts at rest at q = theta = 0 without hysteresis torque.
class SimulatedArm {
 public:
  SimulatedArm(const Rig& rig, Mounting mounting);
  ~SimulatedArm();
  SimulatedArm(const SimulatedArm&) = delete;
  SimulatedArm& operator=(const SimulatedArm&) = delete;

  // advance() integrates to `time`. Corners in the commands of the drives must be announced one after the other, and
  // each must be followed by restart(), so that error control need not detect them.
  void announce_corner(double time);
  void advance(double time);
  void restart();
  // Brings motor `joint` to a standstill where it is, and restarts.
  void stop_motor(int joint);

  double time() const;
  State<double> state() const;
  Joints<double> motor_torque() const;  // tau_m [N m], what the amplifier measures

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace fjr
