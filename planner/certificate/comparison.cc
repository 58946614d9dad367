#include "planner/certificate/comparison.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

namespace fjr {
namespace {

constexpr double kBetweenInstants = 0.25e-3;  // [s] at most

// A NaN counts as infinite: std::max would drop it.
double magnitude(double value) { return std::isnan(value) ? kNoLimit : std::abs(value); }

void raise(double& largest, double value) { largest = std::max(largest, magnitude(value)); }

// Raises `largest` and notes when.
void raise(double& largest, double value, double time, double& when) {
  if (magnitude(value) <= largest) return;
  largest = magnitude(value);
  when = time;
}

class Recorder {
 public:
  Recorder(const Parameters& robot, const Trajectory& trajectory, Comparison& out)
      : robot_(robot), plan_(trajectory), out_(out) {}

  void follow(const Drive& drive) { drive_ = drive; }

  void operator()(double time, const State<double>& x) {
    const Sample plan = plan_.at(time);
    record_torque(time, plan, x);
    for (std::size_t j = 0; j < kJoints; ++j) record_errors(time, plan.state, x, j);
    raise_peaks(x, {}, [](const QuantityInfo& quantity) { return !quantity.sees_torque; });
  }

  // Called at every step, because feedback has peaks much shorter than the distance of the instants where a motor
  // passes through its friction step.
  void torque_at(double time, const State<double>& x) { record_torque(time, plan_.at(time), x); }

 private:
  void record_torque(double time, const Sample& plan, const State<double>& x) {
    const Joints<double> feedback = drive_.feedback(plan.state, x);
    for (std::size_t j = 0; j < kJoints; ++j) {
      raise(out_.feedback_torque[j], feedback[j], time, out_.time_of_feedback[j]);
    }
    raise_peaks(x, {plan.torque[0] + feedback[0], plan.torque[1] + feedback[1]},
                [](const QuantityInfo& quantity) { return quantity.sees_torque; });
  }

  template <class Which>
  void raise_peaks(const State<double>& x, const Joints<double>& torque, const Which& which) {
    const Joints<double> no_rate{};
    raise(out_.peaks, {robot_, x, torque, no_rate}, which);
  }

  void record_errors(double time, const State<double>& plan, const State<double>& x, std::size_t j) {
    const double link = x.q[j] - plan.q[j];
    if (magnitude(link) > out_.errors.max_link()) out_.errors.time_of_max_link = time;
    raise(out_.errors.link[j], link);
    raise(out_.errors.motor[j], x.theta[j] - plan.theta[j]);
    out_.errors.final_link[j] = magnitude(link);
    raise(out_.link_velocity_error[j], x.dq[j] - plan.dq[j], time, out_.time_of_max_link_velocity);
    raise(out_.motor_velocity_error[j], x.dtheta[j] - plan.dtheta[j], time, out_.time_of_max_motor_velocity[j]);
  }

  const Parameters& robot_;
  Interpolator plan_;
  Drive drive_;
  Comparison& out_;
};

}  // namespace

std::vector<double> comparison_instants(const Trajectory& trajectory) {
  std::vector<double> instants;
  for (std::size_t k = 1; k < trajectory.samples.size(); ++k) {
    const double from = trajectory.samples[k - 1].time, to = trajectory.samples[k].time;
    const double pieces = std::ceil((to - from) / kBetweenInstants - 1e-6);
    for (double i = 1; i < pieces; ++i) instants.push_back(from + (to - from) * i / pieces);
    instants.push_back(to);
  }
  return instants;
}

std::vector<Piece> open_loop_pieces(const Parameters& robot, const Trajectory& trajectory,
                                    const std::vector<Stretch>& stretches) {
  std::set<double> ends{trajectory.end_time()};
  for (const Stretch& stretch : stretches) ends.insert({stretch.from, stretch.to});
  ends.erase(trajectory.start_time());
  const Drive closed = stretches.empty() ? Drive{} : Drive::closed_loop(trajectory, robot);
  std::vector<Piece> pieces;
  double from = trajectory.start_time();
  for (const double to : ends) {
    Piece piece{to, Drive::open_loop(trajectory), pieces.empty()};
    for (const Stretch& stretch : stretches) {
      piece.afresh |= stretch.to == from;
      if (stretch.joint == 0 || stretch.from > from || stretch.to < to) continue;
      const auto j = static_cast<std::size_t>(stretch.joint - 1);
      piece.drive.position_gain[j] = closed.position_gain[j];
      piece.drive.velocity_gain[j] = closed.velocity_gain[j];
      piece.drive.dither = closed.dither;
    }
    pieces.push_back(piece);
    from = to;
  }
  return pieces;
}

Comparison compare(Rollout& rollout, const Parameters& robot, const Trajectory& trajectory,
                   const std::vector<Piece>& pieces, const std::vector<double>& instants, double corner) {
  Comparison out;
  Recorder record(robot, trajectory, out);
  Interpolator plan(trajectory);
  const std::vector<double> corners = torque_corners(trajectory, corner);
  const auto keep_events = [&] {
    out.events.insert(out.events.end(), rollout.events().begin(), rollout.events().end());
  };
  std::span<const double> left = instants;
  double from = trajectory.start_time();
  rollout.limit_step(longest_step(trajectory));
  rollout.watch_steps([&](double time, const State<double>& x) { record.torque_at(time, x); });
  for (const Piece& piece : pieces) {
    record.follow(piece.drive);
    if (piece.afresh) {
      if (from > trajectory.start_time()) keep_events();
      rollout.start(from, plan.at(from).state, piece.drive);
      record(from, rollout.state());
    } else {
      rollout.redirect(piece.drive);
    }
    const auto count = static_cast<std::size_t>(std::upper_bound(left.begin(), left.end(), piece.to) - left.begin());
    out.errors.completed = rollout.run(piece.to, left.first(count), corners,
                                       [&](double time, const State<double>& x) { record(time, x); });
    out.errors.failure = rollout.failure();
    if (!out.errors.completed) break;
    left = left.subspan(count);
    from = piece.to;
  }
  rollout.watch_steps({});
  keep_events();
  out.final = rollout.state();
  return out;
}

Comparison compare(Rollout& rollout, const Parameters& robot, const Trajectory& trajectory, const Drive& drive,
                   const std::vector<double>& instants, double corner) {
  return compare(rollout, robot, trajectory, std::vector<Piece>{{trajectory.end_time(), drive, true}}, instants,
                 corner);
}

}  // namespace fjr
