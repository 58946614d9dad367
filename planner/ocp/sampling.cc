#include "planner/ocp/sampling.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/friction.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

constexpr double kShortestPiece = 2e-5;  // [s] a torque change within less time acts on the motors like a step
constexpr double kStepReach = 5e-6;      // [s] on both sides of a reversal, after which friction has changed its sign
constexpr int kChordPoints = 8;          // points at which a piece is compared with its chord

class Sampler {
 public:
  Sampler(const Problem& problem, const Motion& motion, double velocity_error)
      : problem_(problem),
        motion_(motion),
        velocity_error_(velocity_error),
        friction_{FrictionLaw::of(problem.robot, 0), FrictionLaw::of(problem.robot, 1)} {}

  Trajectory rows() {
    const double period = problem_.sample_period, end = motion_.duration();
    double from = 0;
    add(row(motion_.interval_at(0), 0));
    for (long i = 1; from < end; ++i) {
      const double multiple = static_cast<double>(i) * period;
      const double to = multiple < end - 2 * kJumpSpacing ? multiple : end;
      between(from, to);
      add_row_at(to);
      from = to;
    }
    return std::move(trajectory_);
  }

 private:
  // Returns the interval that contains the time just before `time`. A node less than kJumpSpacing before `time` counts
  // as lying ahead, because between() handles it there.
  std::size_t interval_before(double time) const {
    const std::size_t k = motion_.interval_at(time);
    return k > 0 && motion_.intervals[k].start >= time - kJumpSpacing ? k - 1 : k;
  }

  Sample row(std::size_t interval, double time) const {
    return {time, motion_.state_in(interval, time), torque(interval, time)};
  }

  // Returns tau_m with the friction of the motion's velocities.
  Joints<double> torque(std::size_t interval, double time) const {
    Joints<double> tau = motion_.torque_in(interval, time);
    const State<double> x = motion_.state_in(interval, time);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double limit = problem_.limits.torque[j];
      tau[j] = std::clamp(tau[j] + friction_[j].nonlinear(x.dtheta[j]), -limit, limit);
    }
    return tau;
  }

  void add(const Sample& s) {
    auto& samples = trajectory_.samples;
    if (samples.empty() || s.time > samples.back().time + 0.5 * kJumpSpacing) samples.push_back(s);
  }

  // Adds the sample at a multiple of the sample period. If the torque jumps at that time, the sample lies half way
  // between samples on both sides, so that the jump is neither early nor late. Otherwise the errors of half a
  // microsecond at a hundred jumps could add up.
  void add_row_at(double time) {
    const std::size_t k = interval_before(time);
    Sample here = row(k, time);
    if (k + 1 < motion_.intervals.size()) {
      const double node = motion_.intervals[k + 1].start;
      if (std::abs(node - time) < kJumpSpacing && jumps(k, node)) {
        const double done = std::clamp(0.5 - (node - time) / kJumpSpacing, 0.0, 1.0);
        const Joints<double> after = torque(k + 1, node);
        for (std::size_t j = 0; j < kJoints; ++j) here.torque[j] += done * (after[j] - here.torque[j]);
        add(row(k, time - kJumpSpacing));
      }
    }
    add(here);
  }

  // Adds the samples strictly between two multiples of the period. The nodes of the mesh divide this time into pieces
  // on which the torque is smooth.
  void between(double from, double to) {
    double start = from;
    // The sample at `from` belongs to the interval before it, so that a node right there is handled first.
    std::size_t k = interval_before(from);
    for (; k + 1 < motion_.intervals.size(); ++k) {
      const double node = motion_.intervals[k + 1].start;
      if (node >= to - kJumpSpacing) break;
      if (node - start < kJumpSpacing) {
        if (jumps(k, node)) add(row(k + 1, start + kJumpSpacing));
        continue;
      }
      if (!jumps(k, node)) continue;
      smooth(start, node - kJumpSpacing / 2);
      add(row(k, node - kJumpSpacing / 2));
      add(row(k + 1, node + kJumpSpacing / 2));
      start = node + kJumpSpacing / 2;
    }
    smooth(start, to);
  }

  bool jumps(std::size_t k, double node) const {
    const Joints<double> before = torque(k, node), after = torque(k + 1, node);
    // Linear interpolation to the next sample would miss an impulse of up to jump * period / 2.
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double impulse = std::abs(after[j] - before[j]) * problem_.sample_period / 2;
      if (impulse > velocity_error_ * problem_.robot.motor.inertia[j]) return true;
    }
    return false;
  }

  // Adds pairs of samples inside (from, to) until linear interpolation reproduces the torque's impulse.
  void smooth(double from, double to) {
    if (to - from < 2 * kShortestPiece) return steps(from, to);
    const Joints<double> first = torque(motion_.interval_at(from), from), last = torque(interval_before(to), to);
    Joints<double> impulse{0, 0};
    double worst = 0, split = 0.5 * (from + to);
    for (int i = 1; i < kChordPoints; ++i) {
      const double s = static_cast<double>(i) / kChordPoints, time = from + s * (to - from);
      const Joints<double> tau = torque(motion_.interval_at(time), time);
      for (std::size_t j = 0; j < kJoints; ++j) {
        const double miss = (tau[j] - first[j] - s * (last[j] - first[j])) / problem_.robot.motor.inertia[j];
        impulse[j] += std::abs(miss) * (to - from) / kChordPoints;
        if (std::abs(miss) > worst) {
          worst = std::abs(miss);
          split = time;
        }
      }
    }
    if (std::max(impulse[0], impulse[1]) <= velocity_error_) return;
    split = std::clamp(split, from + kShortestPiece, to - kShortestPiece);
    smooth(from, split);
    add(row(motion_.interval_at(split), split));
    add(row(motion_.interval_at(split + kJumpSpacing), split + kJumpSpacing));
    smooth(split + kJumpSpacing, to);
  }

  double velocity(std::size_t joint, double time) const { return motion_.state_at(time).dtheta[joint]; }

  // Adds samples around steps of the friction torque, which are too fast to be found by bisecting the piece. Where a
  // motor reverses, there is one sample as far before as after the reversal, because the chord between them has the
  // same impulse as the step. Where a motor starts from rest or comes to rest, the step is at an end of the piece, and
  // one sample is added right beside it.
  void steps(double from, double to) {
    std::vector<double> times, beside_rests;
    const auto within_a_step = [&](double time) {
      for (std::size_t i = 0; i + 1 < times.size(); i += 2) {
        if (time > times[i] && time < times[i + 1]) return true;
      }
      return false;
    };
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (velocity(j, from) * velocity(j, to) < 0) {
        const double time = reversal(j, from, to), reach = std::min({kStepReach, time - from, to - time});
        if (reach >= kJumpSpacing / 2) times.insert(times.end(), {time - reach, time + reach});
      } else if (to - from > 2 * kStepReach) {
        for (const double time : {from + kStepReach, to - kStepReach}) {
          if (off_the_chord(j, time, from, to) > velocity_error_) beside_rests.push_back(time);
        }
      }
    }
    std::erase_if(beside_rests, within_a_step);  // the chord over that step would be cut
    times.insert(times.end(), beside_rests.begin(), beside_rests.end());
    std::sort(times.begin(), times.end());
    for (const double time : times) {
      if (time > trajectory_.samples.back().time) add(row(motion_.interval_at(time), time));
    }
  }

  double reversal(std::size_t joint, double from, double to) const {
    const double first = velocity(joint, from);
    double before = from, after = to;
    while (after - before > 0.01 * kJumpSpacing) {
      const double middle = (before + after) / 2;
      (velocity(joint, middle) * first > 0 ? before : after) = middle;
    }
    return before;
  }

  // Returns the velocity error [rad/s] of the chord over a piece, if the torque deviates from it everywhere as much as
  // at `time`.
  double off_the_chord(std::size_t joint, double time, double from, double to) const {
    const double first = torque(motion_.interval_at(from), from)[joint], last = torque(interval_before(to), to)[joint];
    const double miss =
        torque(motion_.interval_at(time), time)[joint] - std::lerp(first, last, (time - from) / (to - from));
    return std::abs(miss) * (to - from) / problem_.robot.motor.inertia[joint];
  }

  const Problem& problem_;
  const Motion& motion_;
  double velocity_error_;  // [rad/s] allowed error by linear interpolation of the torque between two samples
  Joints<FrictionLaw> friction_;
  Trajectory trajectory_;
};

}  // namespace

Eigen::MatrixXd integrate_positions(const Eigen::MatrixXd& state, double duration) {
  const Eigen::Index degree = state.cols() - 1;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(state.rows(), state.cols() + 1);
  result.leftCols(state.cols()) = state;
  for (const auto& [positions, velocities] : {std::pair{kStateQ, kStateDq}, std::pair{kStateTheta, kStateDtheta}}) {
    for (Eigen::Index j = 0; j < kJoints; ++j) {
      for (Eigen::Index d = 0; d <= degree; ++d) {
        result(positions + j, d + 1) = duration * state(velocities + j, d) / static_cast<double>(d + 1);
      }
    }
  }
  return result;
}

Motion with_integrated_positions(Motion motion, const Mesh& mesh) {
  if (integrates_velocities(motion.intervals.front().state)) return motion;
  for (std::size_t first = 0, end = 0; first < mesh.size(); first = end) {
    std::vector<Eigen::VectorXd> missed{Eigen::VectorXd::Zero(kStates)};  // at the nodes of the segment
    for (; end < mesh.size() && mesh.intervals[end].segment == mesh.intervals[first].segment; ++end) {
      Motion::Interval& interval = motion.intervals[end];
      const Eigen::VectorXd node = interval.state.rowwise().sum();
      interval.state = integrate_positions(interval.state, interval.duration);
      missed.push_back(missed.back() + interval.state.rowwise().sum() - node);
    }
    const Motion::Interval& last = motion.intervals[end - 1];
    const double begin = motion.intervals[first].start;
    const Eigen::VectorXd slope = missed.back() / (last.start + last.duration - begin);
    for (std::size_t k = first; k < end; ++k) {
      Motion::Interval& interval = motion.intervals[k];
      interval.state.col(0) += missed[k - first] - slope * (interval.start - begin);
      interval.state.col(1) -= slope * interval.duration;
    }
  }
  return motion;
}

Trajectory sample(const Problem& problem, const Motion& motion, double velocity_error) {
  return Sampler(problem, motion, velocity_error).rows();
}

}  // namespace fjr
