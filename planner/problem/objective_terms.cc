#include "planner/problem/objective_terms.h"

#include <limits>

#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

constexpr double kStill = 1e-9;  // [rad/s, m/s] what roundings leave of a rest

template <class Property>
bool any_with(const Weights& weights, Property property) {
  return std::any_of(Terms::infos.begin(), Terms::infos.end(),
                     [&](const TermInfo& term) { return weights.*term.weight > 0 && property(term); });
}

}  // namespace

double TorqueRate::published(const Published& p) {
  const Motion& motion = p.motion;
  double sum = 0;
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    const auto& interval = motion.intervals[k];
    // Chords of an eighth of an interval are enough, because u is linear or follows a collocation polynomial.
    constexpr int kPieces = 8;
    for (int i = 0; i < kPieces; ++i) {
      const double h = interval.duration / kPieces, from = interval.start + i * h;
      const Joints<double> a = motion.torque_in(k, from), b = motion.torque_in(k, from + h);
      for (std::size_t j = 0; j < kJoints; ++j) sum += (b[j] - a[j]) * (b[j] - a[j]) / h;
    }
    if (k + 1 == motion.intervals.size()) continue;
    const double node = motion.intervals[k + 1].start;
    const Joints<double> before = motion.torque_in(k, node), after = motion.torque_in(k + 1, node);
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (std::abs(after[j] - before[j]) > 1e-6) return std::numeric_limits<double>::infinity();
    }
  }
  return sum;
}

double PeakTorque::published(const Published& p) {
  Joints<double> peak{0, 0};
  for (const Sample& row : p.rows.samples) {
    for (std::size_t j = 0; j < kJoints; ++j) peak[j] = std::max(peak[j], std::abs(row.torque[j]));
  }
  // If the motion ends at rest, the motors go on holding the arm there.
  const State<double>& last = p.rows.samples.back().state;
  const bool rests = sum_of_squares(last.dq) + sum_of_squares(last.dtheta) < kStill * kStill;
  const Joints<double> held = gravity_torque(p.robot, last.q);
  for (std::size_t j = 0; j < kJoints && rests; ++j) peak[j] = std::max(peak[j], std::abs(held[j]));
  return peak[0] + peak[1];
}

double TipSpeed::published(const Published& p) {
  const State<double> x = Interpolator(p.rows).at(p.release).state;
  const double speed = std::sqrt(std::max(0.0, tip_speed_squared(p.robot, x.q[1], x.dq)));
  return speed < kStill ? 0 : speed;
}

bool has_peak(const Weights& weights) {
  return weights.peak_torque > 0 && weights.peak_torque * PeakTorque::info.size >= objective_scale(weights);
}

bool sees_friction(const Weights& weights) {
  return has_peak(weights) || any_with(weights, [](const TermInfo& term) { return term.sees_friction; });
}

bool settles_torque(const Weights& weights) {
  return any_with(weights, [](const TermInfo& term) { return term.settles_torque; });
}

bool only_time(const Weights& weights) {
  return !any_with(weights, [](const TermInfo& term) { return term.weight != &Weights::time; });
}

bool sees_acceleration(const Weights& weights) {
  return any_with(weights, [](const TermInfo& term) { return term.sees_acceleration; });
}

bool has_reward(const Weights& weights) {
  return any_with(weights, [](const TermInfo& term) { return term.reward; });
}

bool has_closed_loop(const Weights& weights) {
  return any_with(weights, [](const TermInfo& term) { return term.of_closed_loop; });
}

Weights without_closed_loop(Weights weights) {
  for (const TermInfo& term : Terms::infos) {
    if (term.of_closed_loop) weights.*term.weight = 0;
  }
  return weights;
}

int starts_worth_trying(const Weights& weights) {
  int most = 0, least = std::numeric_limits<int>::max();
  for (const TermInfo& term : Terms::infos) {
    if (weights.*term.weight <= 0 || term.starts == 1) continue;
    least = std::min(least, term.starts);
    if (term.sees_friction || term.reward) most = std::max(most, term.starts);
  }
  if (most > 0) return most;
  return least == std::numeric_limits<int>::max() ? 1 : least;
}

double objective_scale(const Weights& weights) {
  double size = 0;
  for (const TermInfo& term : Terms::infos) size = std::max(size, weights.*term.weight * term.size);
  return size;
}

}  // namespace fjr
