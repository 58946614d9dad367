#include "planner/nlp/interior_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/cpu_time.h"
#include "planner/nlp/filter.h"
#include "planner/nlp/kkt_system.h"
#include "planner/nlp/quadratic_program.h"
#include "planner/nlp/slack_form.h"

namespace fjr {
namespace {

using Vector = Eigen::VectorXd;
using Eigen::Index;

constexpr double kErrorScale = 100;  // mean multiplier above which the optimality errors are scaled down (s_max)
constexpr double kAcceptableTolerance = 1e-6, kAcceptableComplementarity = 1e-2;
constexpr int kAcceptableIterations = 15;
constexpr double kSolvedBarrier = 10;              // a barrier problem counts as solved with an error of this times mu
constexpr double kMuFactor = 0.2, kMuPower = 1.5;  // the next mu is the smaller of factor * mu and mu^power
constexpr double kNearBoundary = 0.99;             // lower limit of the fraction-to-the-boundary parameter
constexpr double kFromBounds = 1e-2, kFromBoundsNear = 1e-4, kFromBoundsWarm = 2e-7;  // relative push off the bounds
constexpr double kLeastMultiplier = 1e-9, kLargestEstimate = 1e3;
constexpr double kMultiplierFactor = 1e10;  // a bound's multiplier stays within this factor of mu / slack
constexpr int kCorrections = 4;
constexpr double kWorthCorrecting = 0.99;  // another correction is tried if the violation fell to this fraction
constexpr int kTinySteps = 2;              // largest number of tiny steps in a row
constexpr int kWatchdogTrigger = 10;       // shortened steps in a row before the watchdog takes full ones
constexpr int kWatchedSteps = 3;
constexpr int kSoftSteps = 10;
constexpr double kSoftDecrease = 0.9999;
constexpr int kMostStepsOfQp =
    8;  // most steps to solutions of quadratic programs, if all but the last go part of the way
constexpr double kLeastFraction = 0.25;  // least fraction of the linearised violation that such a step removes

double largest(const Vector& v) { return v.lpNorm<Eigen::Infinity>(); }

using Step = PrimalDual;

class InteriorPoint {
 public:
  InteriorPoint(const Nlp& nlp, const Iterate& start, const SolveOptions& options)
      : nlp_(nlp), options_(options), form_(scaled(nlp, start)), system_(analysed(form_)) {
    const bool monotone = options.barrier_strategy == BarrierStrategy::kMonotone;
    most_complementarity_ = monotone ? (kSolvedBarrier + 1) * options.final_barrier : 1e-4;
    least_mu_ = std::min(options.tolerance, most_complementarity_) / (kSolvedBarrier + 1);
    // If the initial barrier parameter is already the final one, start at the value at which it ends. Ipopt would start
    // with the initial one and lower it only a little at the end.
    mu_ = monotone && options.initial_barrier <= options.final_barrier ? least_mu_
                                                                       : std::max(options.initial_barrier, least_mu_);
    begin_at(start);
  }

  SolveReport run() {
    if (options_.beginning == Beginning::kQuadraticProgram) go_to_solution_of_qp();
    report_.status = iterate();
    report_.iterate = iterate_of(at_);
    report_.objective = own_objective();
    report_.violation = form_.violation(at_.v, c_).own;
    report_.work = work(report_.iterations);
    report_.cost.factorisations = system_.factorisations();
    report_.cost.total = cpu_since(began_);
    return std::move(report_);
  }

 private:
  SlackForm scaled(const Nlp& nlp, const Iterate& start) {
    const CpuTimed timed(report_.cost.evaluation);
    return {nlp, start.x};
  }
  KktSystem analysed(const SlackForm& form) {
    const CpuTimed timed(report_.cost.linear_algebra);
    return {form, options_.both};
  }

  // ---- initialisation (section 3.6) ----

  bool with_multipliers() const { return options_.beginning != Beginning::kPoint; }

  void begin_at(const Iterate& start) {
    const bool near = options_.initial_barrier < 0.05;
    at_.v = form_.from_x(start.x);
    form_.push_off_bounds(at_.v, with_multipliers() ? kFromBoundsWarm : near ? kFromBoundsNear : kFromBounds);
    evaluate(at_.v, f_, c_);
    if (with_multipliers()) {
      at_.y = form_.from_lambda(start.lambda);
      at_.z_lower = form_.from_bound_multipliers(start.z_lower);
      at_.z_upper = form_.from_bound_multipliers(start.z_upper);
      form_.set_slack_multipliers(at_.y, at_.z_lower, at_.z_upper);
    } else {
      at_.y = Vector::Zero(form_.constraints());
      at_.z_lower = near ? Vector(mu_ * inverse_distance_to_lower()) : Vector::Ones(form_.variables());
      at_.z_upper = near ? Vector(mu_ * inverse_distance_to_upper()) : Vector::Ones(form_.variables());
    }
    const Vector least = Vector::Constant(form_.variables(), kLeastMultiplier);
    form_.keep_multipliers_above(least, least, at_);
    if (!with_multipliers()) estimate_multipliers();
    filter_.start(merit(at_.v, f_, c_));
  }

  struct Point {
    PrimalDual at;
    Vector c;
    double f;
  };

  // Begins again at the solution of the quadratic program at the start, if it has one. Slacks follow their constraints
  // there as far as their bounds allow, so that an inequality is violated by no more than what it exceeds them by.
  // Where the linearised constraints contradict the bounds, a step removes a half or a quarter of their violation, and
  // another one goes on from there. Without any such step the start stays as it is.
  void go_to_solution_of_qp() {
    while (steps_of_qp_ < kMostStepsOfQp && may_go_on(0)) {
      differentiate();
      find_dual_residual();
      if (!std::isfinite(f_) || !c_.allFinite() || !dual_.allFinite() || converged()) return;
      ++steps_of_qp_;
      set_hessian();
      double fraction = 1;
      std::optional<PrimalDual> solution = solution_of_qp(fraction);
      while (!solution && fraction > kLeastFraction && may_go_on(0)) solution = solution_of_qp(fraction /= 2);
      if (!solution) return system_.forget_shift();
      Point before = point();
      begin_at(iterate_of(*solution));
      if (!std::isfinite(f_) || !c_.allFinite()) return go_back_to(std::move(before));
      if (fraction == 1) return;
    }
  }
  // Returns the solution of the quadratic program that removes this fraction of the linearised violation, if it has
  // one.
  std::optional<PrimalDual> solution_of_qp(double fraction) {
    const CpuTimed timed(report_.cost.linear_algebra);
    return solve_quadratic_program(form_, system_, at_, gradient_, fraction * c_, mu_, [this] { return may_go_on(0); });
  }
  void go_back_to(Point&& before) {
    go_to(std::move(before));
    filter_.start(merit(at_.v, f_, c_));
    system_.forget_shift();
  }

  Iterate iterate_of(const PrimalDual& at) const {
    return {form_.to_x(at.v), form_.to_lambda(at.y), form_.to_bound_multipliers(at.z_lower),
            form_.to_bound_multipliers(at.z_upper)};
  }

  // Estimates the multipliers of the constraints by least squares of the dual residual.
  void estimate_multipliers() {
    differentiate();
    const CpuTimed timed(report_.cost.linear_algebra);
    if (!system_.factorise_projection(form_)) return;
    Vector right = Vector::Zero(form_.variables() + form_.constraints());
    right.head(form_.variables()) = at_.z_lower - at_.z_upper - gradient_;
    const Vector y = system_.solve(form_, right).tail(form_.constraints());
    if (largest(y) <= kLargestEstimate) at_.y = y;
  }

  // ---- evaluation at the current point ----

  void evaluate(const Vector& v, double& f, Vector& c) {
    const CpuTimed timed(report_.cost.evaluation);
    f = form_.objective(v);
    form_.constraint_values(v, c);
  }
  void differentiate() {
    const CpuTimed timed(report_.cost.evaluation);
    form_.differentiate(at_.v, gradient_);
  }
  void set_hessian() {
    const CpuTimed timed(report_.cost.evaluation);
    form_.set_hessian(at_.v, at_.y);
  }
  Vector inverse_distance_to_lower() const { return form_.inverse_distance_to_lower(at_.v); }
  Vector inverse_distance_to_upper() const { return form_.inverse_distance_to_upper(at_.v); }
  double own_objective() const { return f_ / form_.objective_scale(); }

  Merit merit(const Vector& v, double f, const Vector& c) const {
    double logarithms = 0;
    for (const Index i : form_.lower_bounded) logarithms += std::log(v(i) - form_.lower(i));
    for (const Index i : form_.upper_bounded) logarithms += std::log(form_.upper(i) - v(i));
    return {c.lpNorm<1>(), f - mu_ * logarithms};
  }

  void find_dual_residual() {
    dual_ = gradient_ - at_.z_lower + at_.z_upper;
    form_.add_transposed_jacobian(at_.y, dual_);
  }

  double complementarity(double mu) const {
    double worst = 0;
    for (const Index i : form_.lower_bounded) {
      worst = std::max(worst, std::abs((at_.v(i) - form_.lower(i)) * at_.z_lower(i) - mu));
    }
    for (const Index i : form_.upper_bounded) {
      worst = std::max(worst, std::abs((form_.upper(i) - at_.v(i)) * at_.z_upper(i) - mu));
    }
    return worst;
  }

  double error(double mu, double violation) const {  // (5)
    const auto bounds = static_cast<double>(form_.lower_bounded.size() + form_.upper_bounded.size());
    const double z = at_.z_lower.lpNorm<1>() + at_.z_upper.lpNorm<1>();
    const auto scale = [](double sum, double count) {
      return std::max(kErrorScale, sum / std::max(1.0, count)) / kErrorScale;
    };
    const double dual_scale = scale(at_.y.lpNorm<1>() + z, bounds + static_cast<double>(form_.constraints()));
    return std::max({largest(dual_) / dual_scale, violation, complementarity(mu) / scale(z, bounds)});
  }

  bool converged() const {
    const SlackForm::Violation violation = form_.violation(at_.v, c_);
    return error(0, violation.scaled) <= options_.tolerance && violation.own <= options_.constraint_tolerance &&
           largest(dual_) <= form_.objective_scale() &&
           complementarity(0) <= most_complementarity_ * form_.objective_scale();
  }
  bool acceptable() const {
    const SlackForm::Violation violation = form_.violation(at_.v, c_);
    return error(0, violation.scaled) <= kAcceptableTolerance && violation.own <= 10 * options_.constraint_tolerance &&
           complementarity(0) <= kAcceptableComplementarity * form_.objective_scale();
  }

  // ---- the iteration ----

  SolveStatus iterate() {
    for (int k = 0;; ++k) {
      differentiate();
      find_dual_residual();
      report_.iterations = k;
      if (const auto ended = why_to_end(k)) return *ended;
      lower_barrier();
      if (!set_up_system()) return SolveStatus::kFailed;
      if (!advance()) return SolveStatus::kFailed;
    }
  }

  std::optional<SolveStatus> why_to_end(int k) {
    if (!std::isfinite(f_) || !c_.allFinite() || !dual_.allFinite()) return SolveStatus::kFailed;
    if (converged()) return SolveStatus::kOptimal;
    acceptable_ = acceptable() ? acceptable_ + 1 : 0;
    if (acceptable_ >= kAcceptableIterations) return SolveStatus::kAcceptable;
    if (k >= options_.max_iterations) return SolveStatus::kIterationLimit;
    return may_go_on(k) ? std::nullopt : std::optional(SolveStatus::kStopped);
  }
  bool may_go_on(int k) const {
    return !options_.monitor || options_.monitor({k, own_objective(), largest(c_), work(k)});
  }
  double work(int iterations) const { return work_of(nlp_, steps_of_qp_ + iterations, system_.multiplications()); }

  void lower_barrier() {  // (7)
    while (mu_ > least_mu_ && error(mu_, largest(c_)) <= kSolvedBarrier * mu_) {
      mu_ = std::max(least_mu_, std::min(kMuFactor * mu_, std::pow(mu_, kMuPower)));
      filter_.clear();
      watch_.reset();
      shortened_ = 0;
    }
  }

  bool set_up_system() {
    set_hessian();
    const CpuTimed timed(report_.cost.linear_algebra);
    return system_.factorise(
        form_,
        at_.z_lower.cwiseProduct(inverse_distance_to_lower()) + at_.z_upper.cwiseProduct(inverse_distance_to_upper()),
        mu_);
  }

  // Returns the Newton step for the constraint values c.
  Step step_for(const Vector& c) {
    const CpuTimed timed(report_.cost.linear_algebra);
    const Vector lower = inverse_distance_to_lower(), upper = inverse_distance_to_upper();
    Vector right(form_.variables() + form_.constraints());
    right << mu_ * (lower - upper) - at_.z_lower + at_.z_upper - dual_, -c;
    const Vector solution = system_.solve(form_, right);
    Step step{solution.head(form_.variables()), solution.tail(form_.constraints()), {}, {}};
    step.z_lower =
        lower.cwiseProduct(Vector::Constant(lower.size(), mu_) - at_.z_lower.cwiseProduct(step.v)) - at_.z_lower;
    step.z_upper =
        upper.cwiseProduct(Vector::Constant(upper.size(), mu_) + at_.z_upper.cwiseProduct(step.v)) - at_.z_upper;
    return step;
  }

  // The longest steps allowed by the fraction-to-the-boundary rule (15).
  double fraction_to_boundary() const { return std::max(kNearBoundary, 1 - mu_); }
  double longest(const Vector& dv) const { return form_.longest_step(at_.v, dv, fraction_to_boundary()); }
  double longest_for_multipliers(const Step& step) const {
    return form_.longest_multiplier_step(at_, step, fraction_to_boundary());
  }

  // Makes one step. Returns false if none is found.
  bool advance() {
    Step step = step_for(c_);
    const double relative = (step.v.array().abs() / (1 + at_.v.array().abs())).maxCoeff();
    const bool tiny = relative < 10 * std::numeric_limits<double>::epsilon();
    tiny_steps_ = tiny ? tiny_steps_ + 1 : 0;
    if (tiny_steps_ > kTinySteps) return false;
    if (soft_steps_ > 0) return soft_step(step);
    double alpha = longest(step.v);
    if (tiny) {  // the filter's test would be decided by rounding errors, so it is skipped
      at_.v += alpha * step.v;
      evaluate(at_.v, f_, c_);
    } else {
      filter_.look_from(merit(at_.v, f_, c_), slope(step));
      if (!watch_ && shortened_ >= kWatchdogTrigger) watch_ = Watch{point(), step, filter_.looking_from(), alpha, 0};
      const Search found = watch_ ? watched_search(step, alpha) : search(step, alpha);
      if (found == Search::kNothing) {
        filter_.leave_for_good();
        return soft_step(step);
      }
      shortened_ = found == Search::kAtOnce ? 0 : shortened_ + 1;
    }
    const double alpha_z = longest_for_multipliers(step);
    at_.y += alpha * step.y;
    at_.z_lower += alpha_z * step.z_lower;
    at_.z_upper += alpha_z * step.z_upper;
    keep_multipliers_near();
    return true;
  }

  void keep_multipliers_near() {
    keep_near(form_.lower_bounded, mu_ * inverse_distance_to_lower(), at_.z_lower);
    keep_near(form_.upper_bounded, mu_ * inverse_distance_to_upper(), at_.z_upper);
  }
  static void keep_near(const std::vector<Index>& bounded, const Vector& central, Vector& z) {  // (16)
    for (const Index i : bounded)
      z(i) = std::clamp(z(i), central(i) / kMultiplierFactor, central(i) * kMultiplierFactor);
  }

  double slope(const Step& step) const {
    return (gradient_ - mu_ * (inverse_distance_to_lower() - inverse_distance_to_upper())).dot(step.v);
  }

  // Backtracks from alpha and goes to the first point that the filter accepts. On return, `step` and `alpha` are the
  // ones taken.
  enum class Search { kAtOnce, kShortened, kNothing };
  Search search(Step& step, double& alpha) {
    const Merit trial = try_step(alpha, step.v);
    if (accept(trial, alpha)) return Search::kAtOnce;
    if (trial.violation >= c_.lpNorm<1>() && correct(step, alpha, trial.violation)) return Search::kAtOnce;
    return backtrack(step, alpha);
  }
  Search backtrack(const Step& step, double& alpha) {
    const double shortest = filter_.shortest_step();
    for (alpha /= 2; alpha >= shortest; alpha /= 2) {
      if (accept(try_step(alpha, step.v), alpha)) return Search::kShortened;
    }
    return Search::kNothing;
  }

  // Ipopt's watchdog: after many shortened steps in a row, a few full steps are taken without the filter's test. If one
  // of them reaches a point that is acceptable as seen from the point where this began, the iteration continues there.
  // Otherwise it returns to that point and backtracks.
  Search watched_search(Step& step, double& alpha) {
    const Merit trial = try_step(alpha, step.v);
    filter_.look_from(watch_->from);
    if (accept(trial, watch_->alpha)) {
      watch_.reset();
      return Search::kAtOnce;
    }
    if (std::isfinite(trial.violation) && std::isfinite(trial.barrier) && ++watch_->steps <= kWatchedSteps) {
      go_to_trial();
      return Search::kAtOnce;
    }
    go_to(std::move(watch_->point));
    differentiate();
    find_dual_residual();
    step = std::move(watch_->step);
    alpha = watch_->alpha;
    watch_.reset();
    shortened_ = 0;
    return backtrack(step, alpha);
  }

  // Ipopt's soft restoration: when the filter accepts no step, steps are taken that reduce the residual of the
  // primal-dual system, until the filter accepts one again. Returns false if a step does not reduce it, either.
  bool soft_step(const Step& step) {
    if (++soft_steps_ > kSoftSteps) return false;
    const double alpha = std::min(longest(step.v), longest_for_multipliers(step)), before = system_error();
    filter_.look_from(merit(at_.v, f_, c_), 0);
    const bool accepted = filter_.accepts(try_step(alpha, step.v), 0);
    if (!std::isfinite(trial_f_) || !trial_c_.allFinite()) return false;
    go_to_trial();
    at_.y += alpha * step.y;
    at_.z_lower += alpha * step.z_lower;
    at_.z_upper += alpha * step.z_upper;
    differentiate();
    find_dual_residual();
    if (!accepted && !(system_error() <= kSoftDecrease * before)) return false;
    if (accepted) soft_steps_ = 0;
    keep_multipliers_near();
    return true;
  }

  double system_error() const {
    double products = 0;
    for (const Index i : form_.lower_bounded) products += std::abs((at_.v(i) - form_.lower(i)) * at_.z_lower(i) - mu_);
    for (const Index i : form_.upper_bounded) products += std::abs((form_.upper(i) - at_.v(i)) * at_.z_upper(i) - mu_);
    const auto mean = [](double sum, auto count) { return count == 0 ? 0 : sum / static_cast<double>(count); };
    return mean(dual_.lpNorm<1>(), dual_.size()) + mean(c_.lpNorm<1>(), c_.size()) +
           mean(products, form_.lower_bounded.size() + form_.upper_bounded.size());
  }

  Merit try_step(double alpha, const Vector& dv) {
    trial_ = at_.v + alpha * dv;
    evaluate(trial_, trial_f_, trial_c_);
    return merit(trial_, trial_f_, trial_c_);
  }

  bool accept(const Merit& trial, double alpha) {
    if (!filter_.accepts(trial, alpha)) return false;
    filter_.leave(trial, alpha);
    go_to_trial();
    return true;
  }
  void go_to_trial() {
    at_.v.swap(trial_);
    c_.swap(trial_c_);
    f_ = trial_f_;
  }

  Point point() const { return {at_, c_, f_}; }
  void go_to(Point&& p) {
    at_ = std::move(p.at);
    c_ = std::move(p.c);
    f_ = p.f;
  }

  // Tries second-order corrections of a step that increases the constraint violation (section 2.4).
  bool correct(Step& step, double& alpha, double violation) {
    const double first = alpha;
    double before = c_.lpNorm<1>(), corrected = alpha;
    Vector c = c_;
    for (int i = 0; i < kCorrections && (i == 0 || violation <= kWorthCorrecting * before); ++i) {
      c = corrected * c + trial_c_;
      Step correction = step_for(c);
      corrected = longest(correction.v);
      before = violation;
      const Merit trial = try_step(corrected, correction.v);
      violation = trial.violation;
      if (!accept(trial, first)) continue;
      step = std::move(correction);
      alpha = corrected;
      return true;
    }
    return false;
  }

  const double began_ = cpu_time();
  SolveReport report_;
  const Nlp& nlp_;
  const SolveOptions& options_;
  SlackForm form_;
  KktSystem system_;
  Filter filter_;
  double mu_ = 0, least_mu_ = 0, most_complementarity_ = 0;
  PrimalDual at_;
  double f_ = 0;
  Vector c_, gradient_, dual_;  // at at_.v
  Vector trial_, trial_c_;
  double trial_f_ = 0;
  int steps_of_qp_ = 0, acceptable_ = 0, tiny_steps_ = 0;
  int soft_steps_ = 0;  // number of soft restoration steps so far; 0: not in soft restoration
  int shortened_ = 0;   // number of shortened steps in a row
  struct Watch {
    Point point;
    Step step;
    Filter::Reference from;
    double alpha;
    int steps;
  };
  std::optional<Watch> watch_;
};

}  // namespace

SolveReport solve_by_interior_point(const Nlp& nlp, const Iterate& start, const SolveOptions& options) {
  return InteriorPoint(nlp, start, options).run();
}

}  // namespace fjr
