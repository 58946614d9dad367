#include "planner/trajectory/sampling.h"

#include <algorithm>
#include <cmath>

#include "model/friction.h"

namespace fjr {
namespace {

// What linear interpolation between two rows may do to a motor's velocity [rad/s] by missing the torque's impulse. Half
// a count of the link encoder is 5e-5 rad; the slowest motor forgets a velocity error within 0.14 s (J1/B1), and
// hundreds of rows do not all err to one side.
constexpr double kVelocityError = 1e-4;
constexpr double kShortestPiece = 2e-5;  // [s] passages shorter than this are steps to the motors
constexpr int kProbes = 8;               // points at which a piece is compared with its chord

class Sampler {
 public:
  Sampler(const Problem& problem, const Motion& motion)
      : problem_(problem),
        motion_(motion),
        friction_{FrictionLaw::of(problem.robot, 0), FrictionLaw::of(problem.robot, 1)} {}

  Trajectory rows() {
    const double period = problem_.sample_period, end = motion_.duration();
    double from = 0;
    add(row(motion_.interval_at(0), 0));
    for (long i = 1; from < end; ++i) {
      const double multiple = static_cast<double>(i) * period;
      const double to = multiple < end - 2 * kJumpSpacing ? multiple : end;
      between(from, to);
      add(row(interval_before(to), to));
      from = to;
    }
    return std::move(trajectory_);
  }

 private:
  // The interval that a time belongs to when approached from before. A node that is nearer than a jump is wide counts
  // as ahead: between() meets it there.
  std::size_t interval_before(double time) const {
    const std::size_t k = motion_.interval_at(time);
    return k > 0 && motion_.intervals[k].start >= time - kJumpSpacing ? k - 1 : k;
  }

  Sample row(std::size_t interval, double time) const {
    return {time, motion_.state_in(interval, time), torque(interval, time)};
  }

  Pair<double> torque(std::size_t interval, double time) const {
    Pair<double> tau = motion_.torque_in(interval, time);
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

  // Everything strictly between two ordinary rows: the mesh's nodes cut the stretch into smooth pieces.
  void between(double from, double to) {
    double start = from;
    // The row at `from` belongs to the interval before it: a node right there is met first.
    std::size_t k = interval_before(from);
    for (; k + 1 < motion_.intervals.size(); ++k) {
      const double node = motion_.intervals[k + 1].start;
      if (node >= to - kJumpSpacing) break;
      if (node - start < kJumpSpacing) {
        if (jumps(k, node)) add(row(k + 1, std::max(start, node) + kJumpSpacing));
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
    const Pair<double> before = torque(k, node), after = torque(k + 1, node);
    // The chord over the next row would lose up to jump * period / 2 of impulse.
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double impulse = std::abs(after[j] - before[j]) * problem_.sample_period / 2;
      if (impulse > kVelocityError * problem_.robot.motor.inertia[j]) return true;
    }
    return false;
  }

  // Adds pairs inside (from, to) until chords carry the torque's impulse.
  void smooth(double from, double to) {
    if (to - from < 2 * kShortestPiece) return;
    const Pair<double> first = torque(motion_.interval_at(from), from), last = torque(interval_before(to), to);
    Pair<double> impulse{0, 0};
    double worst = 0, split = 0.5 * (from + to);
    for (int i = 1; i < kProbes; ++i) {
      const double s = static_cast<double>(i) / kProbes, time = from + s * (to - from);
      const Pair<double> tau = torque(motion_.interval_at(time), time);
      for (std::size_t j = 0; j < kJoints; ++j) {
        const double miss = (tau[j] - first[j] - s * (last[j] - first[j])) / problem_.robot.motor.inertia[j];
        impulse[j] += std::abs(miss) * (to - from) / kProbes;
        if (std::abs(miss) > worst) {
          worst = std::abs(miss);
          split = time;
        }
      }
    }
    if (std::max(impulse[0], impulse[1]) <= kVelocityError) return;
    split = std::clamp(split, from + kShortestPiece, to - kShortestPiece);
    smooth(from, split);
    add(row(motion_.interval_at(split), split));
    add(row(motion_.interval_at(split + kJumpSpacing), split + kJumpSpacing));
    smooth(split + kJumpSpacing, to);
  }

  const Problem& problem_;
  const Motion& motion_;
  Pair<FrictionLaw> friction_;
  Trajectory trajectory_;
};

}  // namespace

Trajectory sample(const Problem& problem, const Motion& motion) { return Sampler(problem, motion).rows(); }

}  // namespace fjr
