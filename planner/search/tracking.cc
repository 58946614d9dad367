#include "planner/search/tracking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "model/uncertainty.h"
#include "planner/certificate/robust/tracking_error.h"
#include "planner/ocp/objective.h"
#include "planner/problem/motion_price.h"

namespace fjr {
namespace {

// Mean square over the motion of each state's deviation from its mean.
std::array<double, kStates> variances(const Motion& motion) {
  constexpr int kInstants = 400;
  std::array<double, kStates> sum{}, squares{};
  for (int i = 0; i < kInstants; ++i) {
    const State<double> x = motion.state_at((i + 0.5) / kInstants * motion.duration());
    for (std::size_t s = 0; s < kStates; ++s) {
      sum[s] += x[s] / kInstants;
      squares[s] += x[s] * x[s] / kInstants;
    }
  }
  for (std::size_t s = 0; s < kStates; ++s) squares[s] -= sum[s] * sum[s];
  return squares;
}

// Returns the price of the tracking error linearised about a motion. weight: of the tracking error in the scaled
// objective. least_variance: of a state that hardly moves.
MotionPrice price_near(const Publication& p, const TrackingGradient& gradient, double weight, double stiffness,
                       double least_variance) {
  MotionPrice price{p.solution.motion, p.solution.durations, gradient.pieces, {}};
  for (MotionPrice::Piece& piece : price.pieces) {
    piece.density *= weight;
    for (double& slope : piece.by_state) slope *= weight;
    for (double& slope : piece.by_torque) slope *= weight;
  }
  const std::array<double, kStates> squares = variances(p.solution.motion);
  const double per_second = stiffness * weight * gradient.value / p.solution.motion.duration();
  for (std::size_t s = 0; s < kStates; ++s) price.curvature[s] = per_second / std::max(squares[s], least_variance);
  return price;
}

// Returns the price on a motion, as the optimiser evaluates it.
double value_on(const MotionPrice& price, const Motion& motion, const std::vector<double>& durations) {
  const std::vector<double> ends = segment_ends(price.durations), new_ends = segment_ends(durations);
  double sum = 0;
  for (const MotionPrice::Piece& piece : price.pieces) {
    const double middle = 0.5 * (piece.begin + piece.end);
    const auto s = std::min(static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), middle) - ends.begin()),
                            ends.size() - 1);
    const double stretch = durations[s] / price.durations[s];
    const double time = new_ends[s] - (ends[s] - middle) * stretch;
    const State<double> was = price.near.state_at(middle), is = motion.state_at(time);
    const Joints<double> torque_was = price.near.torque_at(middle), torque_is = motion.torque_at(time);
    double rate = piece.density;
    for (std::size_t i = 0; i < kStates; ++i) {
      const double away = is[i] - was[i];
      rate += piece.by_state[i] * away + 0.5 * price.curvature[i] * away * away;
    }
    for (std::size_t j = 0; j < kJoints; ++j) rate += piece.by_torque[j] * (torque_is[j] - torque_was[j]);
    sum += rate * stretch * (piece.end - piece.begin);
  }
  return sum;
}

void restate(const Problem& asked, Publication& p) {
  p.terms = objective_terms(asked, p.solution, p.trajectory);
  p.objective = weighted_sum(asked.weights, p.terms);
}

// Returns the objective without the tracking error, that is the terms that are optimised directly.
double without_price(const Problem& asked, const Publication& p) {
  return p.objective - asked.weights.tracking * p.terms.at(TrackingError::info.name);
}

// Returns by how much the requested objective should be lower at the new motion, if the linearised price were exact.
double predicted_gain(const MotionPrice& price, const Problem& asked, const Publication& from, const Publication& to,
                      double scale) {
  const auto priced = [&](const Publication& p) { return value_on(price, p.solution.motion, p.solution.durations); };
  return without_price(asked, from) - without_price(asked, to) + scale * (priced(from) - priced(to));
}

// Returns the optimal motion with this price, certified or not.
std::optional<Publication> next_motion(const MotionPrice& price, const Publication& from, const Problem& asked,
                                       Session& session) {
  Problem priced = *from.problem;
  priced.variation.price = std::make_shared<const MotionPrice>(price);
  Continuation c(std::make_shared<const Problem>(std::move(priced)), session, "with a price on its tracking error");
  if (c.resume(from.solution) != ResumeOutcome::kSolved) return std::nullopt;
  return publish(c, asked, session).last;
}

}  // namespace

Problem without_closed_loop(const Problem& asked) {
  Problem searched = asked;
  searched.weights = without_closed_loop(asked.weights);
  return searched;
}

void lower_tracking_error(const Problem& asked, Findings& found, Session& session) {
  if (asked.weights.tracking == 0 || !found.best) return;
  restate(asked, *found.best);
  if (!found.certified()) return;
  session.enter(Phase::kRefining);
  const Uncertainty uncertainty = uncertainty_of(asked.robot);
  const auto gradient_of = [&](const Publication& p) {
    const Timed timed(session, "tracking");
    return tracking_gradient(asked.robot, p.trajectory, uncertainty);
  };
  TrackingGradient gradient = gradient_of(*found.best);
  const TrackingSettings& s = session.settings().tracking;
  double stiffness = s.first_stiffness;
  for (int stalled = 0; stalled < s.stalled && !session.interrupted() && stiffness <= s.most_stiffness;) {
    Publication& best = *found.best;
    const double weight = asked.weights.tracking / found.scale;
    const MotionPrice price = price_near(best, gradient, weight, stiffness, s.least_variance);
    std::optional<Publication> next = next_motion(price, best, asked, session);
    if (!next) {
      stiffness *= s.stiffer;
      ++stalled;
      continue;
    }
    const double predicted = predicted_gain(price, asked, best, *next, found.scale);
    const double gained = best.objective - next->objective, worthwhile = s.worthwhile * std::abs(best.objective);
    const bool better = next->certificate.certified && !next->too_long && gained > 0;
    if (better) {
      found.best = std::move(next);
      gradient = gradient_of(*found.best);
    }
    stalled = better && gained > worthwhile ? 0 : stalled + 1;
    if (better && std::max(gained, predicted) < worthwhile) return;
    if (better && gained > s.trusted * predicted) stiffness = std::max(stiffness / s.softer, s.least_stiffness);
    if (!better || gained < s.distrusted * predicted) stiffness *= s.stiffer;
  }
}

}  // namespace fjr
