#include "planner/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <deque>
#include <iterator>
#include <numeric>

#include "planner/analysis/analysis.h"
#include "planner/certificate/request_check.h"
#include "planner/ocp/collocate.h"
#include "planner/ocp/margins.h"
#include "planner/ocp/objective.h"
#include "planner/ocp/sampling.h"
#include "planner/search/continuation.h"
#include "planner/search/detours.h"
#include "planner/search/guesses.h"
#include "planner/search/ladder.h"
#include "planner/search/refinement.h"
#include "planner/search/worth_refining.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr int kCertificateRounds = 6;   // refinements of one solution for the sake of its certificate
constexpr double kSameDuration = 1e-9;  // share by which a duration may differ from its bound, for rounding
constexpr double kFinerRows = 0.25;     // of what linear interpolation between rows may miss, each time

// Which solutions are refined to the end.
struct Finishing {
  double within;  // relative distance from the best coarse objective that refining may make up
  int most;
};

// Where friction weighs, what it does while it is smooth tells little: of seven first, the fourth has come to 3 % less
// effort than the first. `starts` more than the usual ones add as many: whatever would be refined without them is
// refined with them too, so that more starts never come to less.
Finishing finishing(const Weights& weights, int starts) {
  const int more = std::max(0, starts - starts_worth_trying(weights));
  return sees_friction(weights) ? Finishing{0.05, 5 + more} : Finishing{0.02, 3 + more};
}

// Of the work that a request may take, for finding motions and for refining them; the rest is for saying why there is
// none.
constexpr double kFinding = 0.5, kRefining = 0.8;

// One way per segment: round what is in the way, both ways round where there are two; along the tip's line or arc, and
// where that is wide through its region too. None when nothing asks for it.
std::vector<std::vector<Way>> task_ways(const Problem& problem) {
  constexpr std::size_t kMostWays = 3;
  const Task& task = problem.task;
  const double tolerance = task.line ? task.line->tolerance : task.arc ? task.arc->tolerance : 0;
  if ((task.line || task.arc) && tolerance < kWideTipPath) return {ways_along_tip_path(problem)};
  if (task.path || (!keeps_clear(task) && !task.box && tolerance == 0)) return {};
  std::vector<Joints<double>> points{problem.start.q};
  for (const Via& via : problem.via) points.push_back(via.q);
  points.push_back(problem.goal.q);
  std::vector<std::vector<Way>> all(1);
  std::vector<std::vector<Way>> others;  // of one segment, with its index
  for (std::size_t s = 0; s + 1 < points.size(); ++s) {
    Detours detours = find_detours(problem, s, points[s], points[s + 1], kMostWays);
    if (detours.ways.empty()) detours.ways.push_back(detours.roomiest);
    all.front().push_back(detours.ways.front());
    others.emplace_back(detours.ways.begin() + 1, detours.ways.end());
  }
  for (std::size_t s = 0; s < others.size(); ++s) {  // one segment goes the other way round at a time
    for (const Way& other : others[s]) {
      all.push_back(all.front());
      all.back()[s] = other;
    }
  }
  if (tolerance > 0) all.push_back(ways_along_tip_path(problem));
  return all;
}

double most_work(const Problem& problem, const PlanOptions& options) {
  const double usual = starts_worth_trying(problem.weights);
  return std::max(options.most_work * std::max(1.0, options.starts / usual), options.deadline);
}

constexpr double kWaiting = 0.4;       // share of the duration that a guess waits
constexpr std::size_t kDisplaced = 2;  // starts at least, after the others
constexpr double kFarAway = 0.8;       // [rad] that straight guesses are displaced by
constexpr double kNearBy = 0.3;        // [rad] that the best motion so far is displaced by: minima lie side by side

// The first k of them are the same however many there are.
struct Starts {
  std::vector<Guess> guesses;
  std::size_t guided = 0;  // the first so many are made for the request, the others displaced at random
  std::size_t always = 0;  // the first so many are tried in any case, the others until one leads somewhere
};

Starts starts_of(const Problem& problem, int count) {
  const double duration = duration_guess(problem);
  Starts starts;
  for (const std::vector<Way>& ways : task_ways(problem)) {
    starts.guesses.push_back(way_guess(problem, duration, ways));
  }
  starts.always = std::max(starts.guesses.size(), static_cast<std::size_t>(count));
  // By minimum jerk the fastest motion takes nearly half the iterations (68 in place of 118 in the median of 26
  // motions), and no worse a minimum; for effort the plain guess is often better.
  const bool fast = only_time(problem.weights);
  starts.guesses.push_back(fast ? minimum_jerk_guess(problem, duration) : straight_guess(problem, duration));
  starts.guesses.push_back(fast ? straight_guess(problem, duration) : minimum_jerk_guess(problem, duration));
  if (sees_friction(problem.weights)) {  // with time to spare a motor rests, and when it does makes minima of their own
    starts.guesses.push_back(waiting_guess(minimum_jerk_guess(problem, duration), kWaiting, 0));
    starts.guesses.push_back(waiting_guess(minimum_jerk_guess(problem, duration), 0, kWaiting));
  }
  starts.guided = starts.guesses.size();
  const std::size_t enough = std::max(starts.always, starts.guesses.size() + kDisplaced);
  for (std::uint64_t i = 2; starts.guesses.size() < enough; ++i) {
    starts.guesses.push_back(displaced_guess(problem, duration, kFarAway, problem.seed * 1000 + i));
  }
  return starts;
}

// What is optimised: the objective divided by `scale`, for the optimiser's tolerances and regularisation are meant for
// objectives of order 1 to 100 while weights may be of any size; one problem for each of the goals that are as good.
//
// The fastest motion is looked for whatever it takes, and what it takes is then compared with what is allowed: right
// above the minimum a smoothed problem, whose minimum is some per cent longer, has no motion at all.
std::vector<Problem> alternatives(const Problem& problem, double scale) {
  Problem scaled = problem;
  if (only_time(problem.weights)) scaled.duration.max = kLongestDuration;
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
    settings_.scheme = find_scheme(problem.method);
    most_work_ = most_work(problem, options);
  }

  Plan run() {
    allow(kFinding);
    if (options_.warm) resume();
    if (!plan_.warm && !stopped()) find_starts();
    if (!plan_.warm && !stopped() && plan_.status != PlanStatus::kCertified && !candidates_.empty() && hurries()) {
      candidates_.clear();
      adopt_fastest();
    }
    const bool none = candidates_.empty();  // otherwise what converged may have been coarse only
    if (!plan_.warm && !stopped() && plan_.status != PlanStatus::kCertified && (none || !any_timed(problem_))) {
      find_out_why();
    }
    std::sort(plan_.minima.begin(), plan_.minima.end());
    for (double& objective : plan_.minima) objective *= scale_;
    if (plan_.status == PlanStatus::kCertified && deadline_passed_) {
      plan_.reason = "";  // what was certified in time is the plan, though other starts were not finished
      plan_.cut_by_deadline = true;
    } else if (stopped() && !(deadline_passed_ && plan_.infeasibility)) {
      plan_.infeasibility.reset();
      plan_.status = deadline_passed_ ? PlanStatus::kDeadline : PlanStatus::kCancelled;
      plan_.reason = deadline_passed_ ? fmt::format("the time budget of {} s was used up", options_.deadline)
                                      : "stopped on request";
      plan_.trajectory.reset();
      plan_.certificate.reset();
    } else if (!plan_.certificate || plan_.infeasibility) {
      explain_failure();
    } else if (plan_.status != PlanStatus::kCertified) {
      plan_.reason += how_far();
    }
    if (plan_.certificate) predict_execution();
    if (plan_.solution && plan_.trajectory) plan_.analysis = analyse(*solved_, *plan_.solution, scale_);
    plan_.timing["evaluation"] = plan_.cost.evaluation;
    plan_.timing["linear_algebra"] = plan_.cost.linear_algebra;
    plan_.timing["ipopt"] = plan_.cost.ipopt();
    plan_.timing["cpu"] = static_cast<double>(std::clock() - began_cpu_) / CLOCKS_PER_SEC;
    plan_.timing["total"] = seconds_since(began_);
    return std::move(plan_);
  }

 private:
  // work: done since the last time. [s]
  bool interrupted(double work = 0) {
    work_ += work;
    if (stopped_) return true;
    deadline_passed_ = options_.deadline > 0 && seconds_since(began_) > options_.deadline;
    stopped_ = deadline_passed_ || (options_.cancelled && options_.cancelled());
    return stopped_ || spent();
  }
  // Nothing more is to be done at all.
  bool stopped() const { return stopped_; }
  // The present phase has done what it may.
  bool spent() {
    if (work_ >= allowed_) plan_.cut_by_work = true;
    return work_ >= allowed_;
  }
  // From here, work may come to this share of all; never to less than before.
  void allow(double share) { allowed_ = std::max(allowed_, share * most_work_); }

  Continuation continuation(const Problem& problem, const std::string& label) {
    Continuation c(
        problem, settings_, [this](double work) { return interrupted(work); },
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
      if (c.stages()[i].forgetful) ++plan_.fallbacks.adaptive_barrier;
      const bool limit = c.stages()[i].status == name(SolveStatus::kIterationLimit);
      if (c.stages()[i].level && limit) ++plan_.fallbacks.friction_level;
    }
  }

  void resume() {
    const auto start = Clock::now();
    if (const std::string& method = options_.warm->setup.scheme.name; method != problem_.method) {
      plan_.warm_refusal = fmt::format("it was planned with method {}, and {} is asked for", method, problem_.method);
      return;
    }
    for (const Problem& problem : alternatives_) {
      Continuation c = continuation(problem, "from an earlier plan");
      const bool solved = c.resume(*options_.warm);
      plan_.warm = solved && certify_and_refine(c);
      plan_.warm_refusal = plan_.warm ? "" : why_not_warm(c, solved);
      book(c);
      if (plan_.warm || stopped()) break;
    }
    plan_.timing["warm"] = seconds_since(start) - plan_.timing["certificate"];
  }

  std::string why_not_warm(const Continuation& c, bool solved) const {
    if (stopped()) return "it was stopped before anything came of it";
    if (c.stages().empty()) return "it passes another number of via points";
    if (!solved) return "the optimiser did not converge from it";
    return "what came of it was not certified: " + (failure_.empty() ? plan_.reason : failure_);
  }

  // Why there is no plan; where that leads to a motion after all, from there.
  void find_out_why() {
    allow(1);
    Problem& problem = asked_.emplace(fastest_of_ ? *fastest_of_ : alternatives_.front());
    problem.duration = problem_.duration;
    const WhyNot why = explain(problem, fastest_ ? &*fastest_ : nullptr, fastest_certified_, carried_with_, tools());
    plan_.infeasibility = why.infeasibility;
    if (!why.start || stopped()) return;
    candidates_.clear();
    try_start(problem, *why.start, "from the least slack");
  }

  // Every start on a coarse mesh; what converges to something promising is refined before the next: so what so many
  // starts come to, more of them come to as well.
  void find_starts() {
    const auto start = Clock::now();
    std::vector<const Problem*> open;
    for (const Problem& problem : alternatives_) {
      if (no_way(problem).sentence.empty()) open.push_back(&problem);
    }
    try_starts(open);
    for (const Problem* problem : open) {
      if (!candidates_.empty() || interrupted() || too_short()) break;
      if (auto found = climb(*problem, tools(), plan_.fallbacks)) follow(std::move(*found));
    }
    plan_.timing["starts"] = seconds_since(start) - plan_.timing["finish"] - plan_.timing["certificate"];
  }

  // The alternatives take turns: what one of them came to tells how long the others are worth trying.
  void try_starts(const std::vector<const Problem*>& open) {
    constexpr int kGivenUp = 2;  // failures of an alternative's first starts, while another led somewhere
    constexpr int kNeverGivenUp = -1;
    constexpr std::size_t kBeforeSwinging = 1;  // starts that led nowhere before it is asked whether it has to swing
    constexpr std::size_t kBeforeHurrying = 2;  // and before it is asked whether there is time
    const int count = options_.starts > 0 ? options_.starts : starts_worth_trying(problem_.weights);
    std::vector<Starts> starts;
    std::size_t most = 0;
    for (const Problem* problem : open) {
      starts.push_back(starts_of(*problem, count));
      most = std::max(most, starts.back().guesses.size());
      plan_.starts_planned += static_cast<int>(starts.back().always);
    }
    std::vector<int> failed(open.size(), 0);
    for (std::size_t i = 0; i < most; ++i) {
      if (i == kBeforeSwinging && candidates_.empty()) {
        for (const Problem* problem : open) try_swinging(*problem);
      }
      if (i == kBeforeHurrying && candidates_.empty()) {
        for (const Problem* problem : open) try_from_fastest(*problem);
        if (too_short()) return;
      }
      for (std::size_t a = 0; a < open.size() && !interrupted(); ++a) {
        if (i >= starts[a].guesses.size()) continue;
        if (!candidates_.empty() && (i >= starts[a].always || failed[a] >= kGivenUp)) continue;
        if (i >= starts[a].always) ++plan_.fallbacks.displaced_start;
        const std::string label = fmt::format("start {} of {}", i + 1, std::max(i + 1, starts[a].always));
        const std::optional<Guess> near = i >= starts[a].guided && (i - starts[a].guided) % 2 == 1
                                              ? beside_the_best(*open[a], problem_.seed * 1000 + i)
                                              : std::nullopt;
        const bool met = try_start(*open[a], near ? *near : starts[a].guesses[i], label);
        if (failed[a] >= 0) failed[a] = met ? kNeverGivenUp : failed[a] + 1;
      }
    }
  }

  // Minima lie side by side: from a place near the best motion so far others are met, and in half the iterations.
  std::optional<Guess> beside_the_best(const Problem& problem, std::uint64_t seed) const {
    const Candidate* best = nullptr;
    for (const Candidate& c : candidates_) {
      if (c.problem == &problem && (best == nullptr || c.coarse.objective < best->coarse.objective)) best = &c;
    }
    if (best == nullptr) return std::nullopt;
    return displaced_guess(guess_from(best->motion, best->durations, best->motion.duration()), kNearBy, seed);
  }

  // False when it led to no solution, known or new.
  bool try_start(const Problem& problem, const Guess& guess, const std::string& label) {
    Continuation c = continuation(problem, label);
    const bool found = c.begin(guess, patience_, plan_.minima);
    c.start = ++plan_.starts;
    book(c);
    if (!found && (c.status() == SolveStatus::kOptimal || c.status() == SolveStatus::kAcceptable))
      return true;  // met before
    // What is much harder than what was found already is given up early; counted in iterations, so that it is the same
    // every time.
    if (found) patience_ = std::min(patience_, std::max(100, 2 * c.stages().front().iterations));
    if (found) {
      plan_.minima.push_back(c.stages().front().objective);
      follow(std::move(c));
    } else {
      failures_.push_back(c.status());
      if (!c.obstacle().empty()) obstacle_ = "; in the last attempt " + c.obstacle();
    }
    return found;
  }

  SolveTools tools() {
    return {[this](const Problem& problem, const std::string& label) { return continuation(problem, label); },
            [](const Problem& problem) { return starts_of(problem, 4).guesses; },
            [this](const Continuation& c) { book(c); }, [this] { return interrupted(); }};
  }

  void try_swinging(const Problem& problem) {
    if (!candidates_.empty() || interrupted() || can_be_carried(problem)) return;
    SwungUp swung = swing_up(problem, problem_.duration.max, tools(), plan_.fallbacks);
    if (swung.motion) follow(std::move(*swung.motion));
    if (swung.reached) carried_with_ = swung.reached;
  }

  // The fastest motion of the same request is a feasible start for it, stretched to the time it has; and when even that
  // takes longer than allowed, that is the reason.
  void try_from_fastest(const Problem& problem) {
    const double allowed = problem.duration.max;
    if (!candidates_.empty() || interrupted()) return;
    if (only_time(problem.weights) && problem.duration.min <= kShortestDuration) return;  // that was tried
    ++plan_.fallbacks.from_fastest;
    bool shortest_certified = false;
    std::optional<Continuation> shortest =
        find_fastest(fastest_problems_.emplace_back(fastest_of(problem)), allowed, shortest_certified);
    if (!shortest) return;
    if (!fastest_ || duration_of(*shortest) < duration_of(*fastest_)) {
      fastest_ = shortest;
      fastest_certified_ = shortest_certified;
      fastest_of_ = &problem;
    }
    if (duration_of(*shortest) > allowed || any_timed(problem)) return;
    const double duration = std::clamp(duration_of(*shortest), problem.duration.min, allowed);
    const Collocated& solution = shortest->solution();
    try_start(problem, guess_from(solution.motion, solution.durations, duration), "from the fastest");
    if (!candidates_.empty() || interrupted()) return;
    adopt_fastest();
  }

  // With the exact law, for a smoothed motion may take some per cent longer; where it takes longer than allowed, one
  // that can be published, for how long it takes is told.
  std::optional<Continuation> find_fastest(const Problem& fastest, double allowed, bool& certified) {
    std::optional<Continuation> shortest;
    std::vector<double> known;
    for (const Guess& guess : starts_of(fastest, 4).guesses) {
      if (interrupted() || (shortest && duration_of(*shortest) <= allowed)) break;
      Continuation c = continuation(fastest, "fastest");
      const bool begun = c.begin(guess, patience_, known);
      if (begun) known.push_back(c.stages().front().objective);
      const bool found = begun && c.finish();
      const bool certifies = found && duration_of(c) > allowed && certify_and_refine(c, false);
      book(c);
      if (!found || (shortest && duration_of(c) >= duration_of(*shortest))) continue;
      certified = certifies;
      shortest = std::move(c);
    }
    return shortest;
  }

  // With hardly any time to spare only its own mesh and the exact law have a motion.
  void adopt_fastest() {
    Continuation c = continuation(*fastest_of_, "from the fastest, exact");
    const std::size_t booked = fastest_->stages().size();
    const bool finished = fastest_->finish();
    book(*fastest_, booked);
    const double shortest = duration_of(*fastest_);
    if (!finished || shortest > problem_.duration.max) return;
    const double duration = std::clamp(shortest, problem_.duration.min, problem_.duration.max);
    const bool found = c.adopt(fastest_->solution(), duration);
    book(c);
    if (found) follow(std::move(c));
  }

  // There is a fastest motion, and hardly more time than it takes.
  bool hurries() const {
    return fastest_ && !any_timed(problem_) && !only_time(problem_.weights) &&
           problem_.duration.max < 1.05 * duration_of(*fastest_);
  }

  static double duration_of(const Continuation& c) { return c.solution().motion.duration(); }
  bool too_short() const { return fastest_ && duration_of(*fastest_) > problem_.duration.max; }

  // What was found on a coarse mesh, to the end if that promises something; the best certified one is the plan. While
  // nothing is certified, everything is worth it.
  void follow(Continuation c) {
    const Collocated& coarse = c.solution();
    candidates_.push_back({&c.problem(), {coarse.report.objective, c.start}, coarse.motion, coarse.durations});
    const bool certified = plan_.status == PlanStatus::kCertified;
    if ((certified && !last_promises()) || interrupted()) return;
    if (far_too_long(c)) {
      note_fastest(c, false);
      return;
    }
    allow(kRefining);
    calm(c);
    const auto start = Clock::now();
    const double certificate = plan_.timing["certificate"];
    const std::size_t booked = c.stages().size();
    booked_of_present_ = c.iterations();
    if (certified) c.to_beat = plan_.objective / scale_;
    if (c.finish()) certify_and_refine(c);
    booked_of_present_ = 0;
    book(c, booked);
    ++plan_.refined;
    plan_.timing["finish"] += seconds_since(start) - (plan_.timing["certificate"] - certificate);
  }

  // Where a speed limit is all that keeps a long motion, springs may swing along it at no cost in time, and more finely
  // than any mesh or rows of many seconds could hold. A trace of link acceleration stills them; what the plan is judged
  // by is the objective that was asked for.
  void calm(Continuation& c) {
    constexpr double kTrace = 0.01;  // [s^4/rad^2]; a motion of 30 s takes 0.2 % longer for it
    if (!only_time(c.problem().weights) || duration_of(c) < kLong) return;
    Problem& problem = calm_problems_.emplace_back(c.problem());
    problem.weights.link_acceleration = kTrace;
    Continuation calmer = continuation(problem, c.label + ", calm");
    calmer.start = c.start;
    const bool found = calmer.begin(guess_from(c.solution().motion, c.solution().durations, duration_of(c)), patience_);
    book(calmer);
    if (found) c = std::move(calmer);
  }

  // Whether the candidate that was found last is worth refining, beside those before it.
  bool last_promises() const {
    std::vector<CoarseSolution> best_first;
    for (const Candidate& c : candidates_) best_first.push_back(c.coarse);
    std::stable_sort(best_first.begin(), best_first.end(),
                     [](const CoarseSolution& a, const CoarseSolution& b) { return a.objective < b.objective; });
    const std::vector<bool> worth = worth_refining(best_first, finishing(problem_.weights, 0).within, [&](int starts) {
      return finishing(problem_.weights, starts).most;
    });
    const int last = candidates_.back().coarse.start;
    for (std::size_t i = 0; i < worth.size(); ++i) {
      if (best_first[i].start == last) return worth[i];
    }
    return true;
  }

  // True when a certified trajectory came of it; kept as the plan unless it is only to tell what is possible.
  bool certify_and_refine(Continuation& c, bool keep = true) {
    double row_error = kRowVelocityError;
    std::size_t rows = 0;
    for (int round = 0; round < kCertificateRounds && !interrupted(); ++round) {
      const auto start = Clock::now();
      Trajectory trajectory = sample(problem_, c.solution().motion, row_error);
      const bool too_long = trajectory.end_time() > problem_.duration.max * (1 + kSameDuration);
      if (trajectory.samples.size() > kMaxRows) {
        failure_ =
            fmt::format("the trajectory needs {} rows, more than the {} allowed: a longer sample_period would do",
                        trajectory.samples.size(), kMaxRows);
        return false;
      }
      Certificate certificate = judge(problem_.robot, problem_.limits, trajectory);
      check_against_request(c.problem(), segment_ends(c), trajectory, certificate);
      if (keep && too_long) note_fastest(c, certificate.certified);
      if (keep && !too_long) record(c, trajectory, certificate);
      plan_.timing["certificate"] += seconds_since(start);
      if (certificate.certified) return !keep || !too_long;
      const int solutions = c.solutions();
      // A limit that only the rows exceed wants a margin; a rest where the arm cannot rest, motion; the rest, accuracy,
      // of the solution and of the rows.
      if (!c.keep_margins(certificate.limits) && !c.creep()) {
        c.refine(rollout_errors(c, trajectory));
        row_error *= kFinerRows;
      }
      c.polish();
      // Neither another motion nor finer rows of this one: the next verdict would be the same.
      if (c.solutions() == solutions && trajectory.samples.size() == rows) return false;
      rows = trajectory.samples.size();
    }
    return false;
  }

  // Motions of many seconds are refined to thousands of intervals. How long the fastest takes is known to a per cent
  // before; where it may not take nearly as long, that is enough to say so.
  static constexpr double kLong = 8;  // [s] coarse meshes of longer motions do not resolve how the springs swing
  bool far_too_long(const Continuation& c) const {
    constexpr double kFar = 1.15;  // times the longest duration
    const double duration = duration_of(c);
    return only_time(problem_.weights) && duration > kLong && duration > kFar * problem_.duration.max;
  }

  // A motion that is as fast as can be, and takes longer than it may.
  void note_fastest(const Continuation& c, bool certified) {
    const bool refined = fastest_ && fastest_of_ == &c.problem() && fastest_->label == c.label;
    if (fastest_ && !refined && duration_of(*fastest_) <= duration_of(c)) return;
    fastest_ = c;
    fastest_certified_ = certified;
    fastest_of_ = &c.problem();
  }

  // Moments [s] at which the segments end.
  static std::vector<double> segment_ends(const Continuation& c) {
    std::vector<double> ends;
    std::partial_sum(c.solution().durations.begin(), c.solution().durations.end(), std::back_inserter(ends));
    return ends;
  }

  void predict_execution() {
    const auto start = Clock::now();
    predict(problem_.robot, *plan_.trajectory, *plan_.certificate);
    plan_.timing["certificate"] += seconds_since(start);
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
    plan_.interval_errors = interval_errors(problem_.robot, solution.motion);
    plan_.node_times = solution.setup.mesh.node_times(solution.durations);
    plan_.status = certificate.certified ? PlanStatus::kCertified : PlanStatus::kUncertified;
    plan_.reason = certificate.certified ? "" : certificate.failures.front();
    plan_.duration = trajectory.end_time();
    plan_.via_times = segment_ends(c);
    plan_.via_times.pop_back();
    plan_.terms = terms;
    plan_.objective = objective;
    plan_.intervals = static_cast<int>(solution.setup.mesh.size());
    plan_.method = solution.setup.scheme.name;
    plan_.error_estimate = *std::max_element(plan_.interval_errors.begin(), plan_.interval_errors.end());
    plan_.back_off = largest_share_kept_free(problem_, solution.setup.margins);
    trajectory.metadata["robot_hash"] = robot_hash(problem_.robot);
    trajectory.metadata["request_hash"] = problem_.request_hash;
    if (certificate.certified) plan_.solution = std::make_shared<const Collocated>(solution);
    solved_ = &c.problem();
    plan_.trajectory = std::move(trajectory);
    plan_.certificate = std::move(certificate);
  }

  // What is known to be impossible is that; where only smoothed motions tell what would have to change, and a motion
  // was found that is not exact enough, that is what there is, with the advice.
  bool only_advice() const {
    const auto& relaxations = plan_.infeasibility->relaxations;
    return plan_.status == PlanStatus::kUncertified && plan_.certificate && !relaxations.empty() &&
           relaxations.front().rough;
  }

  // How far the search came, for whoever wants to go on.
  std::string how_far() const {
    if (!plan_.cut_by_work) return "";
    return fmt::format(
        "; the search ended where a request may take no more (about {:.0f} s of one core), after {} starts and {} "
        "minima: --deadline allows for more",
        most_work_, plan_.starts, plan_.minima.size());
  }

  void explain_failure() {
    if (plan_.infeasibility && only_advice()) {
      plan_.reason += "; " + plan_.infeasibility->sentence + how_far();
      return;
    }
    const bool infeasible = std::find(failures_.begin(), failures_.end(), SolveStatus::kInfeasible) != failures_.end();
    if (plan_.infeasibility) {
      plan_.status = PlanStatus::kInfeasible;
      plan_.reason = plan_.infeasibility->sentence;
      plan_.trajectory.reset();  // what converged on a coarse mesh only
      plan_.certificate.reset();
    } else if (infeasible && candidates_.empty() && !fastest_) {
      plan_.status = PlanStatus::kInfeasible;
      plan_.reason = "no motion within the limits was found from any start" + obstacle_;
    } else {
      plan_.status = PlanStatus::kNotConverged;
      plan_.reason = !failure_.empty()     ? failure_
                     : candidates_.empty() ? "the optimiser converged from no start" + obstacle_
                                           : "the optimiser converged on a coarse mesh, but not on a finer one";
    }
    plan_.reason += how_far();
  }

  const Problem& problem_;
  const double scale_;                       // of the objective
  const std::vector<Problem> alternatives_;  // what is optimised
  int patience_ = 400;                       // iterations a start may take
  const Problem* solved_ = nullptr;          // the one of them that the plan is for
  const PlanOptions& options_;
  ContinuationSettings settings_;
  double work_ = 0, allowed_ = 0, most_work_ = 0;  // [s] done; allowed in the present phase; of all
  const Clock::time_point began_ = Clock::now();
  const std::clock_t began_cpu_ = std::clock();
  bool stopped_ = false, deadline_passed_ = false;
  int booked_of_present_ = 0;  // iterations of the continuation at work that are in plan_.iterations already
  struct Candidate {
    const Problem* problem;
    CoarseSolution coarse;  // on its refined first mesh
    Motion motion;
    std::vector<double> durations;
  };
  std::vector<Candidate> candidates_;     // in the order in which they were found
  std::deque<Problem> calm_problems_;     // of long motions, see calm()
  std::deque<Problem> fastest_problems_;  // of the fastest motions
  std::optional<Continuation> fastest_;   // once it was looked for, the shortest that there is
  bool fastest_certified_ = false;
  const Problem* fastest_of_ = nullptr;  // what it is the fastest motion of
  std::optional<Problem> asked_;         // that one, with the duration that was asked for
  std::optional<Limits> carried_with_;   // limits with which it was found to swing up
  std::vector<SolveStatus> failures_;
  std::string obstacle_;  // what a start without solution failed at
  std::string failure_;   // why a solution could not be published
  Plan plan_;
};

}  // namespace

Plan plan(const Problem& problem, const PlanOptions& options) { return Planner(problem, options).run(); }

}  // namespace fjr
