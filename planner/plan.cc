#include "planner/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "planner/collocation/collocate.h"
#include "planner/collocation/guess.h"
#include "planner/collocation/margins.h"
#include "planner/collocation/refinement.h"
#include "planner/solver/continuation.h"
#include "planner/trajectory/objective.h"
#include "planner/trajectory/sampling.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr int kCertificateRounds = 4;     // refinements of one solution for the sake of its certificate
constexpr double kWorthFinishing = 0.02;  // relative distance from the best coarse objective that refining may make up
constexpr int kMostFinished = 3;          // solutions refined to the end
constexpr double kSameMinimum = 2e-5;     // relative difference of objectives on one mesh below which minima are one

std::vector<Guess> guesses(const Problem& problem, int count) {
  const double duration = duration_guess(problem);
  std::vector<Guess> all{straight_guess(problem, duration), minimum_jerk_guess(problem, duration)};
  for (int i = 2; i < count; ++i) {
    all.push_back(displaced_guess(problem, duration, 0.8, problem.seed * 1000 + static_cast<std::uint64_t>(i)));
  }
  return all;
}

// What is optimised: the objective divided by `scale`, for the optimiser's tolerances and regularisation are meant for
// objectives of order 1 to 100 while weights may be of any size; one problem for each of the goals that are as good.
std::vector<Problem> alternatives(const Problem& problem, double scale) {
  Problem scaled = problem;
  for (const TermInfo& term : Terms::infos) scaled.weights.*term.weight /= scale;
  std::vector<Problem> all{scaled};
  for (const Goal& goal : problem.other_goals) {
    all.push_back(scaled);
    all.back().goal = goal;
  }
  return all;
}

// One request on its way through the pipeline.
class Planner {
 public:
  Planner(const Problem& problem, const PlanOptions& options)
      : problem_(problem),
        scale_(size_of(problem.weights)),
        alternatives_(alternatives(problem, scale_)),
        options_(options) {
    settings_.linear_solver = options.linear_solver;
  }

  Plan run() {
    if (options_.warm) resume();
    if (!plan_.warm && !stopped()) find_starts();
    if (!plan_.warm && !stopped()) finish_best();
    if (plan_.status == PlanStatus::kCertified && deadline_passed_) {
      plan_.reason = "";  // what was certified in time is the plan, though other starts were not finished
    } else if (stopped()) {
      plan_.status = deadline_passed_ ? PlanStatus::kDeadline : PlanStatus::kCancelled;
      plan_.reason = deadline_passed_ ? fmt::format("the time budget of {} s was used up", options_.deadline)
                                      : "stopped on request";
      plan_.trajectory.reset();
      plan_.certificate.reset();
    } else if (!plan_.certificate) {
      explain_failure();
    }
    plan_.timing["evaluation"] = plan_.cost.evaluation;
    plan_.timing["linear_algebra"] = plan_.cost.linear_algebra;
    plan_.timing["ipopt"] = plan_.cost.ipopt();
    plan_.timing["total"] = seconds_since(began_);
    return std::move(plan_);
  }

 private:
  bool interrupted() {
    if (stopped_) return true;
    deadline_passed_ = options_.deadline > 0 && seconds_since(began_) > options_.deadline;
    stopped_ = deadline_passed_ || (options_.cancelled && options_.cancelled());
    return stopped_;
  }
  bool stopped() const { return stopped_; }

  Continuation continuation(const Problem& problem, const std::string& label) {
    Continuation c(
        problem, settings_, [this] { return interrupted(); },
        [this](const Progress& p) {
          if (!options_.on_progress) return;
          Progress overall = p;
          overall.iteration += plan_.iterations - booked_of_present_;
          overall.objective *= scale_;
          options_.on_progress(overall);
        });
    c.label = label;
    return c;
  }

  // Books a start's or a continuation's work since `from` stages.
  void book(const Continuation& c, std::size_t from = 0) {
    for (std::size_t i = from; i < c.stages().size(); ++i) {
      plan_.stages.push_back(c.stages()[i]);
      plan_.stages.back().objective *= scale_;
      plan_.iterations += c.stages()[i].iterations;
      plan_.cost += c.stages()[i].cost;
    }
  }

  void resume() {
    const auto start = Clock::now();
    for (const Problem& problem : alternatives_) {
      Continuation c = continuation(problem, "from an earlier plan");
      plan_.warm = c.resume(*options_.warm) && certify_and_refine(c);
      book(c);
      if (plan_.warm || stopped()) break;
    }
    plan_.timing["warm"] = seconds_since(start) - plan_.timing["certificate"];
  }

  // Every start on a coarse mesh; what converges is kept in order of its objective.
  void find_starts() {
    const auto start = Clock::now();
    for (const Problem& problem : alternatives_) try_starts(problem);
    for (const Problem& problem : alternatives_) {
      if (candidates_.empty() && !interrupted()) try_from_fastest(problem);
    }
    std::stable_sort(candidates_.begin(), candidates_.end(), [](const Continuation& a, const Continuation& b) {
      return a.solution().report.objective < b.solution().report.objective;
    });
    plan_.timing["starts"] = seconds_since(start);
  }

  void try_starts(const Problem& problem) {
    const int count = options_.starts > 0 ? options_.starts : starts_worth_trying(problem.weights);
    const std::vector<Guess> all = guesses(problem, count);
    const std::size_t before = candidates_.size();
    for (std::size_t i = 0; i < all.size() && !interrupted(); ++i) {
      // The further guesses are there for other minima, and for when the first finds nothing.
      if (static_cast<int>(i) >= count && candidates_.size() > before) break;
      try_start(problem, all[i], fmt::format("start {} of {}", i + 1, std::max(static_cast<int>(i) + 1, count)));
    }
  }

  void try_start(const Problem& problem, const Guess& guess, const std::string& label) {
    Continuation c = continuation(problem, label);
    const bool found = c.begin(guess);
    book(c);
    ++plan_.starts;
    if (found) {
      candidates_.push_back(std::move(c));
    } else {
      failures_.push_back(c.status());
      if (!c.obstacle().empty()) obstacle_ = "; in the last attempt " + c.obstacle();
    }
  }

  // The fastest motion of the same request is a feasible start for it, stretched to the time it has; and when even that
  // takes longer than allowed, the reason is found.
  void try_from_fastest(const Problem& problem) {
    Problem fastest = problem;
    fastest.weights = Weights{};
    fastest.weights.time = 1;
    if (std::any_of(problem.via.begin(), problem.via.end(), [](const Via& via) { return via.time.has_value(); }))
      return;
    fastest.duration = {0.02, 20};
    Continuation c = continuation(fastest, "fastest");
    bool found = false;
    for (const Guess& guess : guesses(fastest, 4)) {
      found = !interrupted() && c.begin(guess);
      if (found || stopped()) break;
    }
    book(c);
    if (!found) return;
    shortest_ = c.solution().motion.duration();
    if (shortest_ > problem_.duration.max) return;
    const double duration = std::clamp(shortest_, problem_.duration.min, problem_.duration.max);
    try_start(problem, guess_from(c.solution().motion, c.solution().durations, duration), "from the fastest");
  }

  // Distinct minima are finished in the order of their coarse objectives; the best certified one is the plan. Those
  // that are far behind, or too many, are only looked at when nothing before was certified.
  void finish_best() {
    const auto start = Clock::now();
    std::vector<double> certified;  // first objectives of the minima that came to a plan
    std::vector<double> met;
    const double best = candidates_.empty() ? 0 : candidates_.front().solution().report.objective;
    int finished = 0;
    for (std::size_t i = 0; i < candidates_.size() && !interrupted(); ++i) {
      const double first = candidates_[i].stages().front().objective;  // on the mesh that all starts share
      if (!any_same(met, first)) met.push_back(first);
      plan_.distinct_minima = static_cast<int>(met.size());
      if (any_same(certified, first)) continue;
      const bool promising = candidates_[i].solution().report.objective < best + kWorthFinishing * std::abs(best) &&
                             finished < kMostFinished;
      if (plan_.status == PlanStatus::kCertified && !promising) continue;
      Continuation& c = candidates_[i];
      const std::size_t booked = c.stages().size();
      booked_of_present_ = c.iterations();
      if (c.finish() && certify_and_refine(c)) certified.push_back(first);
      booked_of_present_ = 0;
      book(c, booked);
      ++finished;
    }
    plan_.timing["finish"] = seconds_since(start) - plan_.timing["certificate"];
  }

  static bool any_same(const std::vector<double>& minima, double objective) {
    return std::any_of(minima.begin(), minima.end(), [=](double other) {
      return std::abs(objective - other) <= kSameMinimum * std::max(std::abs(objective), std::abs(other));
    });
  }

  // True when a certified trajectory came of it.
  bool certify_and_refine(Continuation& c) {
    for (int round = 0; round < kCertificateRounds && !interrupted(); ++round) {
      const auto start = Clock::now();
      Trajectory trajectory = sample(problem_, c.solution().motion);
      if (trajectory.samples.size() > kMaxRows) {
        failure_ =
            fmt::format("the trajectory needs {} rows, more than the {} allowed: a longer sample_period would do",
                        trajectory.samples.size(), kMaxRows);
        return false;
      }
      Certificate certificate = certify(problem_.robot, problem_.limits, trajectory);
      check_against_request(c, trajectory, certificate);
      const bool certified = certificate.certified;
      const std::vector<LimitCheck> limits = certificate.limits;
      const std::vector<double> errors = rollout_errors(c, trajectory);
      record(c, std::move(trajectory), std::move(certificate));
      plan_.timing["certificate"] += seconds_since(start);
      if (certified) return true;
      // A limit that only the rows exceed wants a margin; a rest where the arm cannot rest, motion; the rest, accuracy.
      if (!c.keep_margins(limits) && !c.creep() && !c.refine(errors)) return false;
      c.polish();
    }
    return false;
  }

  // The certificate is about a trajectory and a robot; that it is also the motion asked for is checked here.
  void check_against_request(const Continuation& c, const Trajectory& trajectory, Certificate& certificate) const {
    const auto fail = [&certificate](const std::string& what) {
      certificate.certified = false;
      certificate.failures.push_back(what);
    };
    constexpr double kMet = 1e-7;  // [rad], [rad/s]: a hundred times the optimiser's constraint tolerance
    const auto differ = [](const Pair<double>& a, const Pair<double>& b) {
      return std::max(std::abs(a[0] - b[0]), std::abs(a[1] - b[1])) > kMet;
    };
    const State<double>&first = trajectory.samples.front().state, &last = trajectory.samples.back().state;
    const State<double>& start = problem_.start;
    if (differ(first.q, start.q) || differ(first.dq, start.dq) || differ(first.theta, start.theta) ||
        differ(first.dtheta, start.dtheta)) {
      fail("the first row is not the start");
    }
    const Goal& goal = c.problem().goal;
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!goal.free[j] && std::abs(last.q[j] - goal.q[j]) > kMet) fail("the last row is not the goal");
    }
    if ((!goal.dq_free && differ(last.dq, goal.dq)) || (goal.theta && differ(last.theta, *goal.theta)) ||
        (goal.dtheta && differ(last.dtheta, *goal.dtheta))) {
      fail("the last row is not the goal");
    }
    Interpolator at(trajectory);
    double time = 0;
    for (std::size_t i = 0; i < problem_.via.size(); ++i) {
      const Via& via = problem_.via[i];
      time = via.time.value_or(time + c.solution().durations[i]);
      const Pair<double> q = at.at(time).state.q;  // between rows the interpolation of positions is good to 1e-6 rad
      if (std::max(std::abs(q[0] - via.q[0]), std::abs(q[1] - via.q[1])) > via.tolerance + 1e-5) {
        fail(fmt::format("via point {} is missed at {:.6f} s", i + 1, time));
      }
    }
    if (goal.at_rest && !certificate.residual.evaluated) fail("the motion does not end at rest");
  }

  // Local errors of the published rows against the exact model; where the rollout has no answer, the mesh's own
  // estimate.
  std::vector<double> rollout_errors(const Continuation& c, const Trajectory& trajectory) const {
    const Collocated& solution = c.solution();
    std::vector<double> errors = interval_errors(problem_.robot, solution.motion);
    const auto local = local_errors(problem_.robot, trajectory, solution.setup.mesh.node_times(solution.durations));
    for (std::size_t k = 0; k < errors.size(); ++k) {
      if (const double size = error_size(local[k]); std::isfinite(size)) errors[k] = std::max(errors[k], size);
    }
    return errors;
  }

  // Keeps the trajectory as the plan unless a better certified one is already there. Of several that failed the last,
  // and best refined, is reported.
  void record(const Continuation& c, Trajectory trajectory, Certificate certificate) {
    const Collocated& solution = c.solution();
    const auto terms = objective_terms(problem_, solution, trajectory);
    const double objective = weighted_sum(problem_.weights, terms);
    if (plan_.status == PlanStatus::kCertified && (!certificate.certified || objective >= plan_.objective)) return;
    const std::vector<double> errors = interval_errors(problem_.robot, solution.motion);
    plan_.status = certificate.certified ? PlanStatus::kCertified : PlanStatus::kUncertified;
    plan_.reason = certificate.certified ? "" : certificate.failures.front();
    plan_.duration = trajectory.end_time();
    plan_.terms = terms;
    plan_.objective = objective;
    plan_.intervals = static_cast<int>(solution.setup.mesh.size());
    plan_.method = solution.setup.scheme.name;
    plan_.error_estimate = *std::max_element(errors.begin(), errors.end());
    plan_.back_off = largest_share_kept_free(problem_, solution.setup.margins);
    trajectory.metadata["robot_hash"] = robot_hash(problem_.robot);
    trajectory.metadata["request_hash"] = problem_.request_hash;
    if (certificate.certified) plan_.solution = std::make_shared<const Collocated>(solution);
    plan_.trajectory = std::move(trajectory);
    plan_.certificate = std::move(certificate);
  }

  void explain_failure() {
    const bool infeasible = std::find(failures_.begin(), failures_.end(), SolveStatus::kInfeasible) != failures_.end();
    if (shortest_ > problem_.duration.max) {
      plan_.status = PlanStatus::kInfeasible;
      plan_.reason = fmt::format(
          "duration: at most {:.6g} s is allowed, the shortest motion found within the limits takes {:.4f} s",
          problem_.duration.max, shortest_);
    } else if (infeasible && candidates_.empty()) {
      plan_.status = PlanStatus::kInfeasible;
      plan_.reason = "no motion within the limits was found from any start" + obstacle_;
    } else {
      plan_.status = PlanStatus::kNotConverged;
      plan_.reason = !failure_.empty()     ? failure_
                     : candidates_.empty() ? "the optimiser converged from no start" + obstacle_
                                           : "the optimiser converged on a coarse mesh, but not on a finer one";
    }
  }

  const Problem& problem_;
  const double scale_;                       // of the objective
  const std::vector<Problem> alternatives_;  // what is optimised
  const PlanOptions& options_;
  ContinuationSettings settings_;
  const Clock::time_point began_ = Clock::now();
  bool stopped_ = false, deadline_passed_ = false;
  int booked_of_present_ = 0;  // iterations of the continuation at work that are in plan_.iterations already
  std::vector<Continuation> candidates_;
  std::vector<SolveStatus> failures_;
  std::string obstacle_;  // what a start without solution failed at
  std::string failure_;   // why a solution could not be published
  double shortest_ = 0;   // [s] duration of the fastest motion, once it was looked for
  Plan plan_;
};

}  // namespace

Plan plan(const Problem& problem, const PlanOptions& options) { return Planner(problem, options).run(); }

}  // namespace fjr
