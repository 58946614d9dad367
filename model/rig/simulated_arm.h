// The arm on its rig, integrated by CVODE: links free, clamped or taken off, motors driven in one of their modes.
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

// One motor's drive. Its inner loops are taken as perfect: in interpolated position and in velocity mode the motor does
// exactly what it is told (`motion`), in torque mode the torque is exactly the commanded one (`torque`). One is set.
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
  std::function<Joints<double>(double time)> push;  // [N m] on the links; none: nothing pushes
};

// Adams-Moulton with fixed-point iteration: the springs are not stiff, and BDF would damp the very oscillations whose
// decay is to be identified. Starts at rest at q = theta = 0 with a fresh spring.
class SimulatedArm {
 public:
  SimulatedArm(const Rig& rig, Mounting mounting);
  ~SimulatedArm();
  SimulatedArm(const SimulatedArm&) = delete;
  SimulatedArm& operator=(const SimulatedArm&) = delete;

  // Integrates to `time`. Corners of the drives are announced, one after the other, and each is followed by restart():
  // error control should not have to discover them.
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
