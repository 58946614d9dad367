// Integration of the exact model by SUNDIALS' ARKODE: Dormand-Prince of order 5 and, where a motor stays in the steep
// part of its friction, a diagonally implicit method of order 3 with the exact Jacobian. The torque has a corner at
// nearly every row. One-step methods lose nothing there, while a multistep method has to restart (CVODE's BDF took four
// times as long for the same accuracy).
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/dynamics.h"
#include "planner/control/motor_feedback.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Input of the motors: tau_m(t, x) = tau(t) + Kp (theta(t) - theta) + Kd (dtheta(t) - dtheta), where tau(t), theta(t)
// and dtheta(t) are a trajectory's, or one sample held for ever. In open loop both gains are zero. In closed loop the
// executor's dither is added where the plan rests.
struct Drive {
  const Trajectory* plan = nullptr;  // outlives the rollout; none: `held`
  Sample held{};
  Joints<double> position_gain{};  // [N m/rad]    Kp
  Joints<double> velocity_gain{};  // [N m s/rad]  Kd
  std::shared_ptr<const PlannedDither> dither{};

  static Drive open_loop(const Trajectory& plan) { return {&plan, {}, {}, {}}; }
  static Drive closed_loop(const Trajectory& plan, const Parameters& p) {
    return {&plan, {}, p.feedback.position_gain, p.feedback.velocity_gain, std::make_shared<PlannedDither>(p, plan)};
  }
  static Drive holding(const Sample& held) { return {nullptr, held, {}, {}}; }

  // Kp (theta_ref - theta) + Kd (dtheta_ref - dtheta). [N m]
  Joints<double> feedback(const State<double>& reference, const State<double>& x) const {
    Joints<double> f;
    for (std::size_t j = 0; j < kJoints; ++j) {
      f[j] =
          position_gain[j] * (reference.theta[j] - x.theta[j]) + velocity_gain[j] * (reference.dtheta[j] - x.dtheta[j]);
    }
    return f;
  }
};

// Error control per step: |error of x_i| <= relative |x_i| + absolute.
struct Accuracy {
  double relative;
  double position;        // [rad]    absolute, q and theta
  double link_velocity;   // [rad/s]  absolute, dq
  double motor_velocity;  // [rad/s]  absolute, dtheta; well below the width of the friction step, 1.45e-4 rad/s

  static Accuracy of_certificates() { return {1e-8, 1e-10, 1e-9, 1e-9}; }
  static Accuracy of_predictions() { return {1e-6, 1e-8, 1e-7, 1e-7}; }
};

// A sign change found inside a step.
struct Event {
  double time = 0;                         // [s]
  const QuantityInfo* exceeded = nullptr;  // whose limit is exceeded; none: the motor reverses
  int joint = 0;                           // 1 or 2
};

inline constexpr double kLongestStep = 1e-3;  // [s]

// One integrator, restarted as often as wanted. Not copyable, not movable: ARKODE keeps pointers into it.
class Rollout {
 public:
  // Finite limits of the robot are watched, except for torques: crossing one is recorded as an event, and so are
  // reversals of the motors if any is watched.
  Rollout(const Parameters& robot, const Limits& limits, const Accuracy& accuracy);
  ~Rollout();
  Rollout(const Rollout&) = delete;
  Rollout& operator=(const Rollout&) = delete;

  // Sets the state at `time`; the drive's plan must outlive the rollout.
  void start(double time, const State<double>& state, const Drive& drive);
  // Changes the drive and continues from the state reached so far.
  void redirect(const Drive& drive);
  // Changes the held torque in the middle of a rollout, which continues with its present step size. Only with
  // Drive::holding().
  void hold(const Joints<double>& torque);
  // Sets torques that act on the links from now on, beside springs and gravity. [N m]
  void push_links(const Joints<double>& torque);

  using Observer = std::function<void(double time, const State<double>& state)>;

  // Integrates to `end` [s] and calls observe at every one of `instants` (increasing, in (now, end]). At each of
  // `stops` (increasing) the method ends a step exactly: these are corners of the torque that error control should not
  // have to discover. Returns false if the integration broke down; failure() then says why, and start() has to be
  // called before the next run.
  bool run(double end, std::span<const double> instants, std::span<const double> stops, const Observer& observe);

  // Calls observe from now on also at the end of every step that run() takes, which are short where something changes
  // fast. An empty function ends this.
  void watch_steps(Observer observe);

  // Limits the length of steps. [s]
  void limit_step(double longest);

  double time() const;
  const State<double>& state() const;
  const std::vector<Event>& events() const;
  const std::string& failure() const;
  long evaluations() const;  // of the model since construction: what a rollout costs

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

// Returns the times [s] at which a rollout of this torque has to stop: both rows of every jump, and rows at which its
// slope changes by more than `slope_change` [N m/s].
std::vector<double> torque_corners(const Trajectory& trajectory, double slope_change);

// Returns the longest step [s] for rolling this trajectory out: no more than a whole row interval, so that every row is
// seen, and no more than 1 ms, a third of the time in which the instability grows that a rollout has to show (motor 2
// at rest, 365/s).
double longest_step(const Trajectory& trajectory);

}  // namespace fjr
