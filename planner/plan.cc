#include "planner/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "planner/collocation/guess.h"
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
constexpr double kSameMinimum = 1e-3;     // relative difference of objectives below which two minima count as one

// Minimum time has one minimum for practical purposes. Effort at a given time has many: swinging through the springs,
// parking in friction, waiting.
int default_starts(const Problem& problem) {
  if (problem.weights.effort == 0 && problem.weights.link_acceleration == 0) return 1;
  return problem.weights.link_acceleration > 0 ? 2 : 6;
}

std::vector<Guess> guesses(const Problem& problem, int count) {
  const double duration = duration_guess(problem);
  std::vector<Guess> all{straight_guess(problem, duration), minimum_jerk_guess(problem, duration)};
  for (int i = 2; i < count; ++i) {
    all.push_back(displaced_guess(problem, duration, 0.8, problem.seed * 1000 + static_cast<std::uint64_t>(i)));
  }
  return all;
}

// One request on its way through the pipeline.
class Planner {
 public:
  Planner(const Problem& problem, const PlanOptions& options) : problem_(problem), options_(options) {
    settings_.linear_solver = options.linear_solver;
  }

  Plan run() {
    find_starts();
    if (!stopped()) finish_best();
    if (!plan_.certificate && !stopped()) explain_failure();
    if (stopped()) {
      plan_.status = deadline_passed() ? PlanStatus::kDeadline : PlanStatus::kCancelled;
      plan_.reason = deadline_passed() ? fmt::format("the time budget of {} s was used up", options_.deadline)
                                       : "stopped on request";
      plan_.trajectory.reset();
      plan_.certificate.reset();
    }
    plan_.timing["total"] = seconds_since(began_);
    return std::move(plan_);
  }

 private:
  bool deadline_passed() const { return options_.deadline > 0 && seconds_since(began_) > options_.deadline; }
  bool interrupted() {
    stopped_ = stopped_ || deadline_passed() || (options_.cancelled && options_.cancelled());
    return stopped_;
  }
  bool stopped() const { return stopped_; }

  Continuation continuation(const Problem& problem, const std::string& label) {
    Continuation c(
        problem, settings_, [this] { return interrupted(); },
        [this](const Progress& p) {
          if (!options_.on_progress) return;
          Progress overall = p;
          overall.iteration += plan_.iterations;
          options_.on_progress(overall);
        });
    c.label = label;
    return c;
  }

  // Books a start's or a continuation's work since `from` stages.
  void book(const Continuation& c, std::size_t from = 0) {
    for (std::size_t i = from; i < c.stages().size(); ++i) {
      plan_.stages.push_back(c.stages()[i]);
      plan_.iterations += c.stages()[i].iterations;
    }
  }

  // Every start on a coarse mesh; what converges is kept in order of its objective.
  void find_starts() {
    const auto start = Clock::now();
    const int count = options_.starts > 0 ? options_.starts : default_starts(problem_);
    const std::vector<Guess> all = guesses(problem_, count);
    for (std::size_t i = 0; i < all.size() && !interrupted(); ++i) {
      // The further guesses are there for other minima, and for when the first finds nothing.
      if (static_cast<int>(i) >= count && !candidates_.empty()) break;
      try_start(all[i], fmt::format("start {} of {}", i + 1, count));
    }
    if (candidates_.empty() && !interrupted()) try_from_fastest();
    std::stable_sort(candidates_.begin(), candidates_.end(), [](const Continuation& a, const Continuation& b) {
      return a.solution().report.objective < b.solution().report.objective;
    });
    plan_.timing["starts"] = seconds_since(start);
  }

  void try_start(const Guess& guess, const std::string& label) {
    Continuation c = continuation(problem_, label);
    const bool found = c.begin(guess);
    book(c);
    ++plan_.starts;
    if (found) {
      candidates_.push_back(std::move(c));
    } else {
      failures_.push_back(c.status());
    }
  }

  // The fastest motion of the same request is a feasible start for it, stretched to the time it has; and when even that
  // takes longer than allowed, the reason is found.
  void try_from_fastest() {
    Problem fastest = problem_;
    fastest.weights = Weights{};
    fastest.weights.time = 1;
    if (!problem_.via.empty()) return;  // via points come with a fixed duration
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
    try_start(guess_from(c.solution().motion, duration), "from the fastest");
  }

  // Distinct minima are finished in the order of their coarse objectives; the best certified one is the plan. Those
  // that are far behind, or too many, are only looked at when nothing before was certified.
  void finish_best() {
    const auto start = Clock::now();
    std::vector<double> coarse;  // objectives before finishing, in ascending order
    for (const Continuation& c : candidates_) coarse.push_back(c.solution().report.objective);
    int finished = 0;
    for (std::size_t i = 0; i < candidates_.size() && !interrupted(); ++i) {
      if (i > 0 && same_minimum(coarse[i], coarse[i - 1])) continue;
      ++plan_.distinct_minima;
      const bool promising = coarse[i] < (1 + kWorthFinishing) * coarse.front() && finished < kMostFinished;
      if (plan_.status == PlanStatus::kCertified && !promising) continue;
      Continuation& c = candidates_[i];
      const std::size_t booked = c.stages().size();
      if (c.finish()) certify_and_refine(c);
      book(c, booked);
      ++finished;
    }
    plan_.timing["finish"] = seconds_since(start) - plan_.timing["certificate"];
  }

  static bool same_minimum(double x, double y) {
    return std::abs(x - y) <= kSameMinimum * std::max(std::abs(x), std::abs(y));
  }

  void certify_and_refine(Continuation& c) {
    for (int round = 0; round < kCertificateRounds && !interrupted(); ++round) {
      const auto start = Clock::now();
      Trajectory trajectory = sample(problem_, c.solution().motion);
      if (trajectory.samples.size() > kMaxRows) {
        plan_.reason =
            fmt::format("the trajectory needs {} rows, more than the {} allowed", trajectory.samples.size(), kMaxRows);
        return;
      }
      Certificate certificate = certify(problem_.robot, problem_.limits, trajectory);
      const bool certified = certificate.certified;
      const std::vector<double> errors = rollout_errors(c, trajectory);
      if (certified || !plan_.certificate) record(c, std::move(trajectory), std::move(certificate));
      plan_.timing["certificate"] += seconds_since(start);
      if (certified) return;
      // A plan that rests where the arm cannot is not a matter of accuracy.
      if (!c.creep() && !c.refine(errors)) return;
      if (!c.keep_margins()) return;
    }
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

  // Keeps the trajectory as the plan unless a better certified one is already there.
  void record(const Continuation& c, Trajectory trajectory, Certificate certificate) {
    const Collocated& solution = c.solution();
    const auto terms = objective_terms(problem_, solution.motion, trajectory);
    const double objective = weighted_sum(problem_.weights, terms);
    if (plan_.status == PlanStatus::kCertified && objective >= plan_.objective) return;
    const std::vector<double> errors = interval_errors(problem_.robot, solution.motion);
    plan_.status = certificate.certified ? PlanStatus::kCertified : PlanStatus::kUncertified;
    plan_.reason = certificate.certified ? "" : certificate.failures.front();
    plan_.duration = trajectory.end_time();
    plan_.terms = terms;
    plan_.objective = objective;
    plan_.intervals = static_cast<int>(solution.setup.mesh.size());
    plan_.method = solution.setup.scheme.name;
    plan_.error_estimate = *std::max_element(errors.begin(), errors.end());
    plan_.back_off = kBackOff;
    trajectory.metadata["robot_hash"] = robot_hash(problem_.robot);
    trajectory.metadata["request_hash"] = problem_.request_hash;
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
      plan_.reason = "no motion within the limits was found from any start";
    } else {
      plan_.status = PlanStatus::kNotConverged;
      plan_.reason = "the optimiser converged from no start";
    }
  }

  const Problem& problem_;
  const PlanOptions& options_;
  ContinuationSettings settings_;
  const Clock::time_point began_ = Clock::now();
  bool stopped_ = false;
  std::vector<Continuation> candidates_;
  std::vector<SolveStatus> failures_;
  double shortest_ = 0;  // [s] duration of the fastest motion, once it was looked for
  Plan plan_;
};

}  // namespace

Plan plan(const Problem& problem, const PlanOptions& options) { return Planner(problem, options).run(); }

}  // namespace fjr
