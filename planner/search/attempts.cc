#include "planner/search/attempts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/ocp/margins.h"
#include "planner/ocp/moving_nodes.h"

namespace fjr {

Attempts::Attempts(std::shared_ptr<const Problem> problem, Session& session, std::string label, double iteration_factor)
    : problem_(std::move(problem)), session_(&session), label_(std::move(label)), iteration_factor_(iteration_factor) {}

SolveOptions Attempts::options(const std::string& what) {
  SolveOptions o;
  o.linear_solver = session_->options().linear_solver;
  o.max_iterations = static_cast<int>(std::lround(iteration_factor_ * settings().warm.iterations));
  o.monitor = [this, what, told = 0.0](const IterationInfo& info) mutable {
    session_->tell({what, info.iteration, info.objective, info.violation});
    const double more = info.work - std::exchange(told, info.work);
    return !session_->interrupted(more);
  };
  return o;
}

// Rewards are solved by Ipopt: a reward is maximised, so its Hessian is not positive definite at the solution. There
// our own method takes 1.6 times Ipopt's iterations (bench/README.md), and some of its solutions miss the certificate.
SolveOptions Attempts::warm_options(const std::string& what) {
  SolveOptions o = options(what);
  o.beginning = Beginning::kMultipliers;
  o.optimiser = has_reward(problem_->weights) ? Optimiser::kIpopt : Optimiser::kInteriorPoint;
  o.barrier_strategy = BarrierStrategy::kMonotone;
  o.initial_barrier = o.final_barrier = settings().warm.barrier;
  return o;
}

SolveOptions Attempts::loose_options(const std::string& what) {
  SolveOptions o = warm_options(what);
  if (sees_friction(problem_->weights) && !has_peak(problem_->weights)) return o;
  o.tolerance = settings().tightening.round_tolerance;
  o.constraint_tolerance = settings().tightening.round_violation;
  return o;
}

// Margins that are all zero are the same as none.
bool Attempts::Attempt::same_as(const Attempt& other) const {
  const auto none = [](const PerLimit& margins) {
    return std::all_of(margins.begin(), margins.end(), [](double margin) { return margin == 0; });
  };
  const auto margins = [&](const CollocationSetup& s) {
    return std::all_of(s.margins.begin(), s.margins.end(), none) ? std::vector<PerLimit>{} : s.margins;
  };
  const Smoothing &a = setup.smoothing, &b = other.setup.smoothing;
  return how == other.how && most_iterations == other.most_iterations && barrier == other.barrier &&
         beginning == other.beginning && setup.mesh == other.setup.mesh && a.friction_width == b.friction_width &&
         a.regularisation == b.regularisation && setup.creep == other.setup.creep &&
         margins(setup) == margins(other.setup);
}

bool Attempts::attempt(const std::string& what, Attempt attempt, const SolveOptions& o,
                       const std::function<Collocated(const SolveOptions&)>& solve) {
  if (session_->interrupted()) {
    status_ = SolveStatus::kStopped;
    return false;
  }
  for (const Attempt& before : failed_) {
    if (!before.same_as(attempt)) continue;
    status_ = before.status;
    return false;
  }
  Collocated next = session_->in_pairs([&](const DoBoth& both) {
    SolveOptions in_pairs = o;
    in_pairs.both = both;
    return solve(in_pairs);
  });
  const std::size_t intervals = next.setup.mesh.size();
  status_ = next.report.status;
  stages_.push_back({what, static_cast<int>(intervals), next.report.iterations, next.report.objective,
                     name(next.report.status), next.report.cost, next.report.work});
  session_->add(stages_.back());
  violation_ = next.report.violation;
  start_fitted_ = !next.motion.intervals.empty();
  if (!next.report.solved()) {
    attempt.status = status_;
    failed_.push_back(std::move(attempt));
    if (!next.motion.intervals.empty()) obstacle_ = worst_excess(*problem_, next.setup.mesh, next.motion);
    return false;
  }
  solution_ = std::move(next);
  failed_.clear();
  ++solutions_;
  return true;
}

bool Attempts::from_guess(const std::string& what, const CollocationSetup& setup, const Guess& guess,
                          const SolveOptions& o) {
  return attempt(what, {setup, Attempt::kFromGuess, o.max_iterations, o.initial_barrier, o.beginning}, o,
                 [&](const SolveOptions& with) { return collocate(*problem_, setup, guess, with); });
}

bool Attempts::warm(const std::string& what, const CollocationSetup& setup, const SolveOptions& o) {
  return warm_from(solution_, what, setup, o);
}

bool Attempts::warm_from(const Collocated& start, const std::string& what, const CollocationSetup& setup,
                         const SolveOptions& o) {
  return attempt(what, {setup, Attempt::kWarm, o.max_iterations, o.initial_barrier, o.beginning}, o,
                 [&](const SolveOptions& with) { return collocate(*problem_, setup, start, with); });
}

bool Attempts::anew(const std::string& what, const CollocationSetup& setup) {
  const Guess guess = guess_of(solution_);
  const std::size_t solves = stages_.size();
  const bool solved = from_guess(what + ", again", setup, guess, options(what + ", again"));
  if (stages_.size() > solves) ++session_->fallbacks().adaptive_barrier;
  return solved;
}

bool Attempts::warm_or_anew(const std::string& what, const CollocationSetup& setup, const SolveOptions& o,
                            const ContinuationStrategy& strategy) {
  if (warm(what, setup, o)) return true;
  return !stopped() && strategy.begins_afresh && anew(what, setup);
}

bool Attempts::moving_nodes(const std::string& what, const std::vector<std::size_t>& nodes, const SolveOptions& o) {
  return attempt(what, {solution_.setup, Attempt::kMovingNodes, o.max_iterations, o.initial_barrier, o.beginning}, o,
                 [&](const SolveOptions& with) { return move_nodes(*problem_, solution_, nodes, with); });
}

void Attempts::replace(Collocated solution) {
  solution_ = std::move(solution);
  failed_.clear();
}

bool Attempts::came_down() const {
  const double before = solution_.report.objective;
  return sees_friction(problem_->weights) &&
         stages_.back().objective < before - settings().warm.worthwhile_decrease * std::abs(before);
}

}  // namespace fjr
