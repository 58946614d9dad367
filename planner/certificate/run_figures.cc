#include "planner/certificate/run_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fjr {
namespace {

// The integral of the squared torques from one sample to the next: linear between them, or held until the later one.
double effort_between(const Sample& a, const Sample& b, bool held) {
  double sum = 0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double begin = held ? b.torque[j] : a.torque[j], end = b.torque[j];
    sum += (begin * begin + begin * end + end * end) / 3;
  }
  return sum * (b.time - a.time);
}

void raise_to_distance(Joints<double>& largest, const Joints<double>& q, const Joints<double>& from) {
  for (std::size_t j = 0; j < kJoints; ++j) largest[j] = std::max(largest[j], std::abs(q[j] - from[j]));
}

double distance(const Joints<double>& q, const Joints<double>& from) { return largest_difference(q, from); }

}  // namespace

RunFigures figures_of(const Parameters& arm, const Trajectory& trajectory, const Simulation& run, double settled) {
  RunFigures figures;
  Interpolator plan(trajectory);
  const double end = trajectory.end_time();
  const Joints<double>& goal = trajectory.samples.back().state.q;
  double last_off = -1;  // [s] after the end, when a link was last too far from the goal
  const Sample* before = nullptr;
  for (const Sample& now : run.samples) {
    raise(figures.peaks, {arm, now.state, now.torque, {}}, [](const QuantityInfo&) { return true; });
    if (now.time <= end) {
      raise_to_distance(figures.link_error, now.state.q, plan.at(now.time).state.q);
      if (before != nullptr) figures.effort += effort_between(*before, now, run.torque_held);
    }
    if (now.time >= end) {
      raise_to_distance(figures.residual, now.state.q, goal);
      if (distance(now.state.q, goal) > settled) last_off = now.time - end;
    }
    before = &now;
  }
  const bool until_the_last = !run.samples.empty() && last_off >= run.samples.back().time - end;
  const bool ended = run.completed && !until_the_last;
  figures.settling_time = ended ? std::max(0.0, last_off) : std::numeric_limits<double>::infinity();
  return figures;
}

}  // namespace fjr
