#include "planner/trajectory/objective.h"

#include <cmath>
#include <limits>

#include "planner/trajectory/sampling.h"

namespace fjr {
namespace {

// int tau^2 over one row interval: exact, tau being linear there.
double squared_integral(const Pair<double>& from, const Pair<double>& to, double time) {
  double sum = 0;
  for (std::size_t j = 0; j < kJoints; ++j) sum += (from[j] * from[j] + from[j] * to[j] + to[j] * to[j]) * time / 3;
  return sum;
}

Pair<double> acceleration(const Parameters& robot, const State<double>& x) {
  return link_acceleration(robot, x.q, x.dq, spring_torque(robot, x.q, x.theta));
}

double torque_rate(const Motion& motion) {
  double sum = 0;
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    const auto& interval = motion.intervals[k];
    constexpr int kPieces = 8;  // chords of an eighth: u is linear, or bends with a collocation polynomial
    for (int i = 0; i < kPieces; ++i) {
      const double h = interval.duration / kPieces, from = interval.start + i * h;
      const Pair<double> a = motion.torque_in(k, from), b = motion.torque_in(k, from + h);
      for (std::size_t j = 0; j < kJoints; ++j) sum += (b[j] - a[j]) * (b[j] - a[j]) / h;
    }
    if (k + 1 == motion.intervals.size()) continue;
    const double node = motion.intervals[k + 1].start;
    const Pair<double> before = motion.torque_in(k, node), after = motion.torque_in(k + 1, node);
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (std::abs(after[j] - before[j]) > 1e-6) return std::numeric_limits<double>::infinity();
    }
  }
  return sum;
}

}  // namespace

std::map<std::string, double> objective_terms(const Problem& problem, const Motion& motion,
                                              const Trajectory& trajectory) {
  double effort = 0, acceleration_squared = 0;
  const auto& rows = trajectory.samples;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const double time = rows[i + 1].time - rows[i].time;
    effort += squared_integral(rows[i].torque, rows[i + 1].torque, time);
    acceleration_squared += squared_integral(acceleration(problem.robot, rows[i].state),
                                             acceleration(problem.robot, rows[i + 1].state), time);
  }
  return {{"time", trajectory.end_time() - trajectory.start_time()},
          {"effort", effort},
          {"torque_rate", torque_rate(motion)},
          {"link_acceleration", acceleration_squared}};
}

double weighted_sum(const Weights& weights, const std::map<std::string, double>& terms) {
  double sum = 0;
  visit_weights(weights, [&](const char* name, double weight) {
    if (weight > 0) sum += weight * terms.at(name);
  });
  return sum;
}

double published_objective(const Problem& problem, const Motion& motion) {
  return weighted_sum(problem.weights, objective_terms(problem, motion, sample(problem, motion)));
}

}  // namespace fjr
