#include "planner/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "planner/analysis/analysis.h"
#include "planner/collocation/detours.h"
#include "planner/collocation/margins.h"
#include "planner/problem/relaxable.h"
#include "planner/solver/continuation.h"

namespace fjr {
namespace {

constexpr std::size_t kMostCandidates = 4;     // things to relax that are looked at
constexpr double kBracket = 0.035;             // what is said suffices; less by this share of the change does not
constexpr int kMostTrials = 12;                // to find one value
constexpr std::size_t kGuesses = 2;            // from which there is no neighbour's solution to start
constexpr int kPatience = 200;                 // iterations of a start from nearby
constexpr double kShares[] = {0.3, 1, 4, 15};  // by which things are relaxed to have a motion at all
constexpr double kWarm = 0.1;     // change relative to a value's size up to which multipliers are worth keeping
constexpr double kNoGain = 0.01;  // share of the missing time that relaxing has to bring to be worth pursuing

// Something to relax, with when it is in the way and, where known, how fast relaxing helps.
struct Candidate {
  Relaxable what;
  std::optional<double> time;  // [s]
  double worth = 0;            // [s] per unit of amount
};

class Explanation {
 public:
  Explanation(const Problem& problem, const Continuation* fastest, const SolveTools& tools)
      : problem_(problem), fastest_(fastest), tools_(tools) {}

  std::optional<Infeasibility> run() {
    if (const NoWay barred = no_way(problem_); !barred.sentence.empty()) {
      result_.sentence = barred.sentence;
      base_ = fastest_of(problem_);
      for (const Relaxable& r : relaxables(problem_)) {
        if (std::count(barred.names.begin(), barred.names.end(), r.name) > 0) relax_until_feasible({r, {}, 0});
      }
      if (!barred.names.empty()) result_.limit = barred.names.front();
    } else if (fastest_ != nullptr && shortest() > problem_.duration.max) {
      explain_duration();
    } else if (fastest_ == nullptr || timed()) {
      explain_limits();
    }
    if (result_.sentence.empty()) return std::nullopt;
    add_relaxations_to_sentence();
    return result_;
  }

 private:
  double shortest() const { return fastest_->solution().motion.duration(); }
  bool timed() const {
    return std::any_of(problem_.via.begin(), problem_.via.end(), [](const Via& via) { return via.time.has_value(); });
  }

  Continuation fresh(const Problem& problem, const std::string& what) {
    problems_.push_back(problem);
    return tools_.continuation(problems_.back(), "why not: " + what);
  }

  std::optional<Continuation> booked(Continuation c, bool solved) {
    tools_.book(c);
    return solved ? std::optional<Continuation>(std::move(c)) : std::nullopt;
  }

  // From the solution of a neighbouring problem; `warm`: near enough for its multipliers to be of use.
  std::optional<Continuation> solve(const Problem& problem, const std::string& what, const Continuation& neighbour,
                                    bool warm) {
    const Collocated& near = neighbour.solution();
    if (warm) {
      Continuation c = fresh(problem, what);
      const bool solved = c.resume(near);
      if (auto found = booked(std::move(c), solved)) return found;
    }
    Continuation cold = fresh(problem, what);
    const Guess guess = guess_from(near.motion, near.durations, near.motion.duration());
    const bool solved = cold.begin(guess, kPatience) && cold.finish();
    return booked(std::move(cold), solved);
  }

  // From scratch.
  std::optional<Continuation> solve(const Problem& problem, const std::string& what) {
    const std::vector<Guess> guesses = tools_.guesses(problem);
    for (std::size_t i = 0; i < std::min(kGuesses, guesses.size()) && !tools_.interrupted(); ++i) {
      Continuation c = fresh(problem, what);
      const bool solved = c.begin(guesses[i], kPatience) && c.finish();
      if (auto found = booked(std::move(c), solved)) return found;
    }
    return std::nullopt;
  }

  // ---- a duration that is too short ----

  void explain_duration() {
    const double allowed = problem_.duration.max;
    result_.shortest_duration = shortest();
    result_.sentence =
        fmt::format("duration: at most {:.6g} s is allowed; the shortest motion found within the limits takes {:.4f} s",
                    allowed, shortest());
    result_.limit = "duration";
    result_.time = allowed;
    result_.relaxations.push_back({"duration", 0, "s", allowed, shortest(), true, allowed});
    const std::vector<Candidate> candidates = active_in_fastest();
    for (const Candidate& candidate : candidates) {
      if (tools_.interrupted()) return;
      relax_until_fast_enough(candidate);
    }
    if (result_.relaxations.size() > 1 || candidates.empty()) return;
    Candidate all{all_limits(problem_), {}, 0};
    for (const Candidate& candidate : candidates) all.worth += candidate.worth * size_of(candidate.what);
    relax_until_fast_enough(all);
  }

  // What the fastest motion is limited by, what helps most first.
  std::vector<Candidate> active_in_fastest() const {
    const Analysis analysis = analyse(fastest_->problem(), fastest_->solution(), 1);
    std::vector<Candidate> candidates;
    for (const Relaxable& r : relaxables(fastest_->problem())) {
      Candidate candidate{r, {}, 0};
      double longest = 0;
      for (const LimitWorth& limit : analysis.sensitivity.limits) {
        const bool same = limit.name == r.name && (r.joint == 0 || limit.joint == r.joint);
        if (!same || limit.worth <= 0) continue;
        candidate.worth += limit.worth;
        for (const auto& stretch : limit.active) {
          if (stretch.end - stretch.begin <= longest) continue;
          longest = stretch.end - stretch.begin;
          candidate.time = (stretch.begin + stretch.end) / 2;
        }
      }
      if (candidate.worth > 0) candidates.push_back(candidate);
    }
    const auto size = [](const Candidate& c) { return c.worth * size_of(c.what); };
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](const Candidate& a, const Candidate& b) { return size(a) > size(b); });
    if (candidates.size() > kMostCandidates) candidates.resize(kMostCandidates);
    return candidates;
  }

  // Secant method on the duration of the fastest motion, each solution starting the next.
  void relax_until_fast_enough(const Candidate& candidate) {
    struct Known {
      double amount, time;
    };
    const Relaxable& what = candidate.what;
    const double wanted = problem_.duration.max, missing = shortest() - wanted;
    Known low{0, shortest()};
    std::optional<Known> high;
    std::optional<Continuation> last;
    double present = 0;  // amount of the last solution
    double amount = std::min(what.most, 1.01 * missing / candidate.worth);
    for (int trial = 0; trial < kMostTrials; ++trial) {
      const bool warm = std::abs(amount - present) < kWarm * (size_of(what) + present);
      auto next = solve(what.relaxed(fastest_->problem(), amount), name_of(what), last ? *last : *fastest_, warm);
      if (!next) return;
      const Known known{amount, next->solution().motion.duration()};
      last = std::move(next);
      present = amount;
      const Known before = low;
      (known.time <= wanted ? high.emplace() : low) = known;
      if (high && high->amount - low.amount <= kBracket * high->amount) return add(candidate, high->amount);
      if (!high && (amount >= what.most || low.time > before.time - kNoGain * missing)) return;
      amount = high ? inside(low.amount, high->amount, crossing(low, *high, wanted))
                    : std::min(what.most, std::clamp(1.03 * crossing(before, low, wanted), 1.05 * amount, 4 * amount));
    }
    if (high) add(candidate, high->amount);
  }

  template <class Known>
  static double crossing(const Known& a, const Known& b, double wanted) {
    return a.amount + (wanted - a.time) * (b.amount - a.amount) / (b.time - a.time);
  }

  // A little to that side of the estimate on which more is unknown, so that both sides close in on it.
  static double inside(double low, double high, double estimate) {
    const double share = kBracket / 3, gap = high - low;
    const double trial = high - estimate > estimate - low ? estimate * (1 + share) : estimate * (1 - share);
    return std::clamp(trial, low + 0.03 * gap, high - 0.03 * gap);
  }

  // ---- limits that no motion keeps, however long it takes ----

  void explain_limits() {
    base_ = fastest_ == nullptr ? fastest_of(problem_) : problem_;
    if (fastest_ != nullptr) {
      base_.weights = fastest_->problem().weights;
      result_.shortest_duration = shortest();
      for (std::size_t i = 0; i < problem_.via.size() && !tools_.interrupted(); ++i) move_via(i);
    }
    for (const Candidate& candidate : exceeded_when_relaxed()) {
      if (tools_.interrupted()) break;
      relax_until_feasible(candidate);
    }
    if (result_.relaxations.empty()) return;
    std::stable_sort(result_.relaxations.begin(), result_.relaxations.end(),
                     [](const Relaxation& a, const Relaxation& b) { return change(a) < change(b); });
    const Relaxation& first = result_.relaxations.front();
    result_.limit = first.name;
    result_.joint = first.joint;
    result_.time = first.time;
    const std::string joint = first.joint == 0 ? "" : fmt::format(" of joint {}", first.joint);
    const std::string when = first.time ? fmt::format(" at {:.3f} s", *first.time) : "";
    result_.sentence = fmt::format("no motion found keeps every limit; {}{} is in the way{}", first.name, joint, when);
  }

  static double change(const Relaxation& r) { return std::abs(r.to - r.from) / std::max(std::abs(r.from), 0.1); }

  // With everything relaxed there is a motion; what it exceeds is in the way, what it exceeds most first.
  std::vector<Candidate> exceeded_when_relaxed() {
    for (const double share : kShares) {
      relaxed_ = solve(relaxed(base_, share), "everything relaxed");
      if (relaxed_ || tools_.interrupted()) break;
    }
    static const Motion kNone;
    const Motion& motion = relaxed_ ? relaxed_->solution().motion : kNone;
    const auto excess = relaxed_ ? excesses(base_, relaxed_->solution().setup.mesh, motion) : std::vector<PerLimit>();
    const PerLimit scales = limit_scales(base_);
    std::vector<std::pair<double, Candidate>> found;
    for (const Relaxable& r : relaxables(base_)) {
      Candidate candidate{r, {}, 0};
      double worst = r.unit == "times" ? 1e-3 : 0;  // velocities are always worth a try, after what is exceeded
      for (int joint = 0; joint <= kJoints; ++joint) {
        if (r.joint != 0 && joint != r.joint) continue;
        for (const std::size_t i : indices_of(base_, r.name, joint)) {
          for (std::size_t k = 0; k < excess.size(); ++k) {
            if (!(excess[k][i] / scales[i] > worst)) continue;
            worst = excess[k][i] / scales[i];
            candidate.time = motion.intervals[k].start;
          }
        }
      }
      if (worst > 0) found.emplace_back(worst, candidate);
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Candidate> candidates;
    for (const auto& [worst, candidate] : found) candidates.push_back(candidate);
    if (candidates.size() > kMostCandidates) candidates.resize(kMostCandidates);
    return candidates;
  }

  // Relaxed until there is a motion, and then as little as leaves one.
  void relax_until_feasible(const Candidate& candidate) {
    const Relaxable& what = candidate.what;
    std::optional<Continuation> feasible;
    double high = 0;
    for (const double share : kShares) {
      if (tools_.interrupted() || feasible || high >= what.most) break;
      high = std::min(what.most, share * size_of(what));
      const Problem problem = what.relaxed(base_, high);
      feasible = relaxed_ ? solve(problem, name_of(what), *relaxed_, false) : solve(problem, name_of(what));
    }
    if (!feasible) return;
    double low = 0;
    for (int trial = 0; trial < kMostTrials && high - low > kBracket * high && !tools_.interrupted(); ++trial) {
      const double middle = low == 0 ? high / 3 : (low + high) / 2;
      auto next = solve(what.relaxed(base_, middle), name_of(what), *feasible, true);
      (next ? high : low) = middle;
      if (next) feasible = std::move(next);
    }
    add(candidate, high);
  }

  // A via point's time alone, moved until the rest of the request can be had.
  void move_via(std::size_t i) {
    if (!problem_.via[i].time) return;
    Problem freed = base_;
    freed.via[i].time.reset();
    const std::string name = fmt::format("via[{}].time", i);
    auto feasible = solve(freed, name);
    if (!feasible) return;
    const auto passed = [i](const Continuation& c) {
      const auto& durations = c.solution().durations;
      return std::accumulate(durations.begin(), durations.begin() + static_cast<std::ptrdiff_t>(i) + 1, 0.0);
    };
    const double asked = *problem_.via[i].time;
    double low = asked, high = passed(*feasible);
    for (int trial = 0; trial < kMostTrials; ++trial) {
      if (std::abs(high - low) <= kBracket * std::abs(high - asked) || tools_.interrupted()) break;
      freed.via[i].time = (low + high) / 2;
      auto next = solve(freed, name, *feasible, false);
      (next ? high : low) = *freed.via[i].time;
      if (next) feasible = std::move(next);
    }
    result_.relaxations.push_back({name, 0, "s", asked, high, true, asked});
  }

  // What shares of a change are taken of.
  static double size_of(const Relaxable& what) { return std::max(what.from, 0.1); }

  // ---- telling ----

  static std::string name_of(const Relaxable& what) {
    return what.joint == 0 ? what.name : fmt::format("{} {}", what.name, what.joint);
  }

  void add(const Candidate& candidate, double amount) {
    const Relaxable& what = candidate.what;
    result_.relaxations.push_back(
        {what.name, what.joint, what.unit, what.from, what.value(amount), amount <= what.allowed, candidate.time});
  }

  void add_relaxations_to_sentence() {
    std::string& text = result_.sentence;
    bool any = false;
    for (const Relaxation& r : result_.relaxations) {
      if (r.name == "duration") continue;
      const std::string joint = r.joint == 0 ? "" : fmt::format(" of joint {}", r.joint);
      const std::string unit = r.unit == "times" ? " of what it is" : " " + r.unit;
      const std::string beyond = r.within_robot ? "" : ", more than the robot's";
      any = true;
      if (r.name == "all_limits") {
        text += fmt::format("; no single limit alone would do, but all together {:.4g} times as large{}", r.to, beyond);
        continue;
      }
      text += r.name == "tip_box" ? fmt::format("; tip_box alone would have to be {:.4g} m larger on every side", r.to)
                                  : fmt::format("; {}{} alone would have to be {:.4g}{} (now {:.4g}{})", r.name, joint,
                                                r.to, unit, r.from, beyond);
    }
    if (!any && !tools_.interrupted()) text += "; no other change of a single limit was found to do";
  }

  const Problem& problem_;
  const Continuation* fastest_;
  const SolveTools& tools_;
  Problem base_;                         // what to find any motion for
  std::optional<Continuation> relaxed_;  // a motion with everything relaxed
  std::deque<Problem> problems_;         // of the continuations
  Infeasibility result_;
};

}  // namespace

Problem fastest_of(Problem problem) {
  problem.weights = Weights{};
  problem.weights.time = 1;
  problem.duration = {kShortestDuration, kLongestDuration};
  for (Via& via : problem.via) via.time.reset();
  return problem;
}

std::optional<Infeasibility> explain(const Problem& problem, const Continuation* fastest, const SolveTools& tools) {
  return Explanation(problem, fastest, tools).run();
}

}  // namespace fjr
