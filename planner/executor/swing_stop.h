// Brings links to rest that swing on their springs because their motors were stopped at once. The model's springs have
// no damping: held stiffly, the links would swing on them for ever.
#pragma once

#include <optional>

#include "planner/control/motor_feedback.h"
#include "planner/problem/problem.h"
#include "planner/stop/stop_shape.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr double kLookAtSwing = 0.06;  // [s] until the motors stand still, and the links' velocities are known
inline constexpr double kYield = 0.1, kMostYielding = 3;  // [s] before the links are looked at again; in all

// Where the links are and how fast, while the motors stand: the model goes along, corrected by the encoders.
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

// A motion of the arm, which is flat in q, from swinging with its motors at rest to rest: of the polynomials q(t) that
// leave with the links' position and four derivatives and arrive with four zero ones, the one of lowest degree, in the
// duration that takes least of the limits.
class SwingStop {
 public:
  explicit SwingStop(const Parameters& robot);

  // False: every duration would exceed a limit. Takes 0.1 ms at most, and neither waits nor allocates.
  bool find(double start, const State<double>& swinging);

  double end() const { return start_ + duration_; }
  Sample at(double time) const;  // rest at the end after it

 private:
  double largest_fraction(const Joints<StopShape>& shapes, double duration) const;

  Parameters robot_;
  Limits limits_;
  ShapeTable table_;
  Joints<StopShape> shapes_{};
  double start_ = 0, duration_ = 0;
};

// Of motors that give way to a swing: they hold the links' weight, and brake as viscous dampers that the springs pull
// at, matched to inertia and stiffness so that what swings on them decays fastest. Within the drive's peak torque.
MotorFeedback::Command yielding_torque(const Parameters& robot, const Joints<double>& q, const Joints<double>& dtheta);

}  // namespace fjr
