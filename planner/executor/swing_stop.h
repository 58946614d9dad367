// Brings links to rest that oscillate on their springs because the motors were stopped abruptly. The model's springs
// have no damping, so with the motors held, the links would oscillate forever.
#pragma once

#include <optional>

#include "planner/control/motor_feedback.h"
#include "planner/stop/stop_limits.h"
#include "planner/stop/stop_shape.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr double kLookAtSwing = 0.06;  // [s] until the motors are at rest and the links' velocities are known
inline constexpr double kYield = 0.1, kMostYielding = 3;  // [s] of giving way at a time, and in all

// Observer of the links' positions and velocities while the motors are at rest: the model, corrected by the encoders.
class SwingObserver {
 public:
  explicit SwingObserver(const Parameters& robot) : robot_(robot) {}

  void start(const Joints<double>& q);
  void tick(const Joints<double>& q, const Joints<double>& theta);  // measured; [rad]

  const Joints<double>& q() const { return q_; }
  const Joints<double>& dq() const { return dq_; }

 private:
  Parameters robot_;
  Joints<double> q_{}, dq_{};
};

// A motion from oscillating links with motors at rest to complete rest. Because the arm is differentially flat in q, it
// is given by polynomials q(t) that start with the links' position and four derivatives and end with four zero
// derivatives. The polynomial of lowest degree is used, with the shortest tabulated duration that keeps the limits.
class SwingStop {
 public:
  explicit SwingStop(const Parameters& robot);

  // Finds the motion that begins at the time `start` [s]. Returns false if every duration would exceed a limit. Takes
  // at most 0.1 ms, and neither waits nor allocates.
  bool find(double start, const State<double>& swinging);

  double end() const { return start_ + duration_; }
  Sample at(double time) const;  // after end(): rest at the final position

 private:
  double largest_fraction(const Joints<StopShape>& shapes, double duration) const;

  Parameters robot_;
  PerStopLimit limits_;
  ShapeTable table_;
  Joints<StopShape> shapes_{};
  double start_ = 0, duration_ = 0;
};

// Returns the torque of motors that give way to an oscillation, within the drives' peak torque. They carry the links'
// weight and act as viscous dampers at the ends of the springs, matched to inertia and stiffness for fast decay.
MotorFeedback::Command yielding_torque(const Parameters& robot, const Joints<double>& q, const Joints<double>& dtheta);

}  // namespace fjr
