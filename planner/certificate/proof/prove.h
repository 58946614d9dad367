// Bounds of the exact motion that hold with mathematical certainty: the certificate's rollouts, proved.
#pragma once

#include <functional>
#include <vector>

#include "common/not_stopped.h"
#include "common/parallel.h"
#include "planner/certificate/certificate.h"
#include "planner/certificate/task_of_motion.h"

namespace fjr {

// What has to be proved to hold at all times.
struct Claims {
  double link;                // [rad]   |q - plan|, in open and in closed loop
  double link_velocity;       // [rad/s] |dq - plan|, in closed loop
  Joints<double> feedback{};  // [N m]   in closed loop
  Limits published, rollout;  // of the rows with their interpolation; of the closed loop
  TaskOfMotion task{};        // what both keep
  double task_fraction = 0;   // of a row's scale, by which the rows may miss it; the closed loop by what `link` makes
                              // of the distance besides

  // Those of a certificate.
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

// Asks a certificate for that too: what is certified and not proven is certified no longer, and says why.
void demand_proof(const Parameters& robot, const Limits& limits, const TaskOfMotion& task, const Trajectory& trajectory,
                  Certificate& certificate, const ForEach& for_each = one_after_another,
                  const std::function<bool()>& stopped = not_stopped);

}  // namespace fjr
