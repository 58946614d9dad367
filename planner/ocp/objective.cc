#include "planner/ocp/objective.h"

#include "planner/certificate/robust/tracking_error.h"
#include "planner/ocp/sampling.h"
#include "planner/ocp/segments.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

// Integrates a term by Simpson's rule between consecutive samples. This is exact for tau_m^2, because tau_m is linear
// between samples.
template <class Term>
double integral_over(const Parameters& robot, const Trajectory& trajectory) {
  const auto running = [&robot](const Sample& s) {
    const State<double>& x = s.state;
    const Joints<double> ddq = link_acceleration(robot, x.q, x.dq, spring_torque(robot, x.q, x.theta));
    return Term::running(Instant<double>{robot, x, ddq, s.torque});
  };
  const auto& rows = trajectory.samples;
  Interpolator between(trajectory);
  double sum = 0, before = running(rows.front());
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const double middle = running(between.at(0.5 * (rows[i].time + rows[i + 1].time))), after = running(rows[i + 1]);
    sum += (before + 4 * middle + after) / 6 * (rows[i + 1].time - rows[i].time);
    before = after;
  }
  return sum;
}

// Returns the values of the terms for which wanted(weight) is true.
template <class Wanted>
std::map<std::string, double> terms_of(const Problem& problem, const Collocated& solution, const Trajectory& trajectory,
                                       Wanted wanted) {
  const Published published{solution.motion, trajectory, problem.robot, release_time(problem, solution.durations)};
  std::map<std::string, double> values;
  Terms::visit([&](auto term) {
    const double weight = problem.weights.*term.info.weight;
    if (!wanted(weight) || (term.info.of_closed_loop && weight == 0)) return;
    if constexpr (term.info.of_closed_loop) {
      values[term.info.name] = expected_tracking_error(problem.robot, trajectory, uncertainty_of(problem.robot));
    } else if constexpr (requires { term.published(published); }) {
      values[term.info.name] = term.published(published);
    } else {
      values[term.info.name] = integral_over<decltype(term)>(problem.robot, trajectory);
    }
  });
  return values;
}

}  // namespace

std::map<std::string, double> objective_terms(const Problem& problem, const Collocated& solution,
                                              const Trajectory& trajectory) {
  return terms_of(problem, solution, trajectory, [](double) { return true; });
}

std::map<std::string, double> terms_of_rows(const Parameters& robot, const Trajectory& rows) {
  const Motion none;
  const Published published{none, rows, robot, 0};
  std::map<std::string, double> values;
  Terms::visit([&](auto term) {
    using Term = decltype(term);
    // Terms of the closed loop take long; objective_terms() computes them if they have a weight.
    if constexpr (!Term::info.of_rows || Term::info.of_closed_loop) {
      return;
    } else if constexpr (requires { term.published(published); }) {
      values[term.info.name] = term.published(published);
    } else {
      values[term.info.name] = integral_over<Term>(robot, rows);
    }
  });
  return values;
}

double weighted_sum(const Weights& weights, const std::map<std::string, double>& terms) {
  double sum = 0;
  for (const TermInfo& term : Terms::infos) {
    if (const double weight = signed_weight(weights, term); weight != 0) sum += weight * terms.at(term.name);
  }
  return sum;
}

double published_objective(const Problem& problem, const Collocated& solution) {
  const auto weighted = [](double weight) { return weight > 0; };
  const Motion published = with_integrated_positions(solution.motion, solution.setup.mesh);
  return weighted_sum(problem.weights, terms_of(problem, solution, sample(problem, published), weighted));
}

}  // namespace fjr
