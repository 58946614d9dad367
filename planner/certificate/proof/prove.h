// Proves bounds of the exact motion: the rollouts of a certificate with mathematical certainty.
#pragma once

#include <functional>
#include <vector>

#include "common/not_stopped.h"
#include "common/parallel.h"
#include "planner/certificate/certificate.h"
#include "planner/certificate/task_of_motion.h"

namespace fjr {

// Bounds that have to be proved to hold at all times.
struct Claims {
  double link;                      // [rad]   |q - plan|, in open and in closed loop
  double link_velocity;             // [rad/s] |dq - plan|, in closed loop
  Joints<double> motor_velocity{};  // [rad/s] |dtheta - plan|, in closed loop
  Joints<double> feedback{};        // [N m]   in closed loop
  Limits published, rollout;        // limits of the rows with their interpolation, and of the closed loop
  TaskOfMotion task{};              // task that both have to keep
  double task_fraction = 0;  // fraction of a row's scale by which the rows may miss it; the closed loop may also miss
                             // it by what `link` changes of the distance

  // Returns the claims of a certificate.
  static Claims of(const Parameters& robot, const Limits& limits, const TaskOfMotion& task = {});
};

// Encloses the exact solutions of the model under the published samples, in open and in closed loop, from the exact
// start and over all of the time, and compares them with the plan's cubics, the limits and the task. What is covered,
// what is assumed and how: docs/theory.md. for_each: three independent pieces of work. stopped: asked now and then, by
// both loops; what is stopped is not proven.
Proof prove(const Parameters& robot, const Trajectory& trajectory, const Claims& claims,
            const ForEach& for_each = one_after_another, const std::function<bool()>& stopped = not_stopped);
Proof prove(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& trajectory,
            const ForEach& for_each = one_after_another, const std::function<bool()>& stopped = not_stopped);

// Demands a proof of a certificate: what is certified but not proven is no longer certified, and a failure says why.
void demand_proof(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& trajectory,
                  Certificate& certificate, const ForEach& for_each = one_after_another,
                  const std::function<bool()>& stopped = not_stopped);

}  // namespace fjr
