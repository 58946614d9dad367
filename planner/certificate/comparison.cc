#include "planner/certificate/comparison.h"

#include <algorithm>
#include <cmath>

#include "model/kinematics.h"

namespace fjr {
namespace {

constexpr double kBetweenInstants = 0.25e-3;  // [s] at most

void raise(double& largest, double value) { largest = std::max(largest, std::abs(value)); }

// Raises `largest` and notes when; a NaN counts as infinite.
void raise(double& largest, double value, double time, double& when) {
  const double magnitude = std::isnan(value) ? kNoLimit : std::abs(value);
  if (!(magnitude > largest)) return;
  largest = magnitude;
  when = time;
}

class Recorder {
 public:
  Recorder(const Parameters& robot, const Trajectory& trajectory, const Drive& drive, Comparison& out)
      : robot_(robot), plan_(trajectory), drive_(drive), out_(out) {}

  void operator()(double time, const State<double>& x) {
    const Sample plan = plan_.at(time);
    const Pair<double> feedback = drive_.feedback(plan.state, x);
    for (std::size_t j = 0; j < kJoints; ++j) {
      record_errors(time, plan.state, x, j);
      raise(out_.feedback_torque[j], feedback[j], time, out_.time_of_feedback[j]);
      raise(out_.peaks.torque[j], plan.torque[j] + feedback[j]);
      raise(out_.peaks.motor_velocity[j], x.dtheta[j]);
      raise(out_.peaks.link_position[j], x.q[j]);
      raise(out_.peaks.spring_deflection[j], x.theta[j] - x.q[j]);
    }
    raise(out_.peaks.tip_speed, std::sqrt(tip_speed_squared(robot_, x.q[1], x.dq)));
  }

 private:
  void record_errors(double time, const State<double>& plan, const State<double>& x, std::size_t j) {
    const double link = x.q[j] - plan.q[j];
    if (std::abs(link) > out_.errors.max_link()) out_.errors.time_of_max_link = time;
    raise(out_.errors.link[j], link);
    raise(out_.errors.motor[j], x.theta[j] - plan.theta[j]);
    out_.errors.final_link[j] = std::abs(link);
    raise(out_.link_velocity_error[j], x.dq[j] - plan.dq[j], time, out_.time_of_max_link_velocity);
  }

  const Parameters& robot_;
  Interpolator plan_;
  const Drive& drive_;
  Comparison& out_;
};

}  // namespace

std::vector<double> comparison_instants(const Trajectory& trajectory) {
  std::vector<double> instants;
  for (std::size_t k = 1; k < trajectory.samples.size(); ++k) {
    const double from = trajectory.samples[k - 1].time, to = trajectory.samples[k].time;
    const int pieces = static_cast<int>(std::ceil((to - from) / kBetweenInstants - 1e-6));
    for (int i = 1; i < pieces; ++i) instants.push_back(from + (to - from) * i / pieces);
    instants.push_back(to);
  }
  return instants;
}

Comparison compare(Rollout& rollout, const Parameters& robot, const Trajectory& trajectory, const Drive& drive,
                   const std::vector<double>& instants, double corner) {
  Comparison out;
  Recorder record(robot, trajectory, drive, out);
  record(trajectory.start_time(), trajectory.samples.front().state);
  rollout.limit_step(longest_step(trajectory));
  rollout.start(trajectory.start_time(), trajectory.samples.front().state, drive);
  out.errors.completed = rollout.run(trajectory.end_time(), instants, torque_corners(trajectory, corner),
                                     [&](double time, const State<double>& x) { record(time, x); });
  out.errors.failure = rollout.failure();
  out.events = rollout.events();
  out.final = rollout.state();
  return out;
}

}  // namespace fjr
