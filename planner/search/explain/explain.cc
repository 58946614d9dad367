#include "planner/search/explain/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/problem/relaxable.h"
#include "planner/problem/statics.h"
#include "planner/search/detours.h"
#include "planner/search/explain/candidates.h"
#include "planner/search/explain/search.h"
#include "planner/search/explain/slack.h"
#include "planner/search/explain/via_times.h"
#include "planner/search/fastest.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

constexpr double kMargin =
    0.01;                        // fraction of a change added to it: right at the edge there is one motion, and no plan
constexpr double kSpare = 2e-4;  // fraction of a shortest duration
constexpr std::size_t kSpareRows = 1000;                  // for what comes between the regular ones
constexpr double kMore[] = {1, 1.03, 1.1, 1.25, 1.5, 2};  // times the least change, until planning finds it enough
constexpr double kRoughMargin = 0.1;                      // the same where friction stayed smooth
constexpr double kGridMargin = 1.1;                       // times the clearance that a grid found missing
constexpr double kClose = 0.05;                           // slack of a sketch that a more exact one may do without
constexpr double kPossible = 2e-3;  // slack below which the request is possible, as far as can be told
constexpr double kLoose = 3;        // fraction by which limits are relaxed for a duration to start from
constexpr double kLonger = 2;       // times the duration of a hurried motion that the least change may take

class Explanation {
 public:
  Explanation(const Problem& problem, const Continuation* fastest, bool certified, const std::optional<Limits>& reached,
              Session& session)
      : problem_(problem), fastest_(fastest), certified_(certified), reached_(reached), search_(session) {}

  WhyNot run() {
    if (const NoPath barred = no_path(problem_); !barred.sentence.empty()) {
      explain_barred(barred);
    } else if (fastest_ != nullptr && shortest() > problem_.duration.max) {
      explain_duration();
    } else {
      if (fastest_ != nullptr) result_.shortest_duration = rounded_up(shortest());
      explain_via_times();
      if (result_.sentence.empty() && (fastest_ == nullptr || any_timed(problem_))) explain_limits();
    }
    if (start_) return {{}, start_};
    if (result_.sentence.empty()) return {};
    add_relaxations_to_sentence();
    return {result_, {}};
  }

 private:
  double shortest() const { return fastest_->solution().motion.duration(); }

  // What is told of a shortest duration: rounded up, and with a little to spare, so that a request for it can be met.
  static double rounded_up(double duration) { return std::ceil(1e4 * (1 + kSpare) * duration) / 1e4; }

  // The least change of this one thing that makes the problem possible, from these guesses.
  bool relax(const Problem& problem, const Candidate& candidate, const std::vector<Guess>& guesses) {
    const Problem with_slack_of_it = with_slack(problem, candidate.what);
    auto solution = least(with_slack_of_it, name_of(candidate.what.name, candidate.what.joint), guesses);
    const bool rough = !solution;
    if (rough) solution = search_.last_sketch();
    if (!solution || (rough && solution->solution().slack < kPossible)) return false;
    if (!rough && fastest_ == nullptr && is_possible(*solution)) return false;
    const double slack = (1 + (rough ? kRoughMargin : kMargin)) * solution->solution().slack;
    if (slack > with_slack_of_it.slack->most) return false;
    const Relaxable& what = candidate.what;
    const double to = value_with(problem, what, slack);
    const auto time = candidate.time ? candidate.time : worst_moment(problem, what, solution->solution());
    Relaxation named = relaxation_of(what, to);
    named.rough = rough;
    // Where the fastest is known only about, planning would take as long as was saved by not refining it.
    const bool too_long_to_plan = fastest_ != nullptr && !certified_;
    if (what.constraint || (!rough && named.within_robot && !too_long_to_plan)) {
      named = verified(problem, what, named, guess_of(*solution));
    } else if (too_long_to_plan) {
      named.rough = true;
    }
    named.time = time;
    result_.relaxations.push_back(named);
    return true;
  }

  // A slack is minimised with rows that hold at the collocation points of a coarse mesh, and between them a motion cuts
  // corners. So the motion is planned with the change as it is told, and where that is not enough with more of it.
  Relaxation verified(const Problem& problem, const Relaxable& what, Relaxation named, const Guess& near) {
    const double amount = std::abs(named.to - what.from);
    for (const double more : kMore) {
      if (more * amount > what.most || search_.over()) break;
      const Relaxation tried = relaxation_of(what, what.value(more * amount));
      Problem easier = problem;
      what.set(easier, tried.to);
      if (is_enough(easier, what.name, near)) return tried;
    }
    named.rough = true;
    return named;
  }

  // Whether a motion within the limits takes no longer than it may, found as it would be when asked for or near the one
  // that told the change.
  bool is_enough(const Problem& easier, const std::string& what, const Guess& near) {
    Problem quick = fastest_of(easier);
    if (any_timed(easier)) {
      quick.via = easier.via;
      quick.duration = easier.duration;
    }
    std::vector<Guess> guesses = search_.guesses(quick);
    guesses.push_back(near);
    const auto found = search_.plan(quick, what, guesses);
    return found && (any_timed(easier) || (1 + kSpare) * found->duration() <= easier.duration.max);
  }

  // Without a slack it is a motion for the request itself.
  bool is_possible(const Continuation& solution) {
    if (solution.solution().slack >= kPossible) return false;
    start_ = guess_of(solution);
    return true;
  }

  // Where the duration is free: first with a large weight of time, and then with as much more time as the mesh is fine
  // enough for, since it takes time to gain speed.
  std::optional<Continuation> least(Problem relaxed, const std::string& what, std::vector<Guess> guesses) {
    Duration& duration = relaxed.duration;
    const double soon = kLonger * guesses.front().duration();
    if (!any_timed(problem_) && !relaxed.slack->velocity && duration.max > std::max(soon, duration.min)) {
      const auto first = search_.sketch(hurried(relaxed), what + ", hurried", guesses);
      if (!first) return std::nullopt;
      guesses = {guess_of(*first)};
      duration.max = std::clamp(kLonger * guesses.front().duration(), duration.min, duration.max);
    }
    return search_.solve(relaxed, what, guesses);
  }

  // ---- no way round ----

  void explain_barred(const NoPath& barred) {
    result_.sentence = barred.sentence;
    for (const Relaxable& what : relaxables(problem_)) {
      const auto& bars = barred.constraints;
      if (what.constraint == nullptr || std::count(bars.begin(), bars.end(), what.number) == 0) continue;
      if (result_.limit.empty()) result_.limit = what.name;
      widen(what, barred.missing);
    }
  }

  // A slack finds ways between the collocation points where there is none; the grid does not. More than is missing is
  // needed where the way is between two things, for half of what one gives up is lost to the other side, and where the
  // optimiser does not find a motion along a way that is barely open.
  void widen(const Relaxable& what, double missing) {
    if (missing == 0) return;
    for (const double more : {1.0, 1.5, 2.0}) {
      const double amount = more * kGridMargin * missing;
      if (amount >= what.most || search_.over()) return;
      const Problem wider = what.relaxed(problem_, amount);
      if (!no_path(wider).sentence.empty()) continue;
      if (!search_.solve(wider, what.name, search_.guesses(wider))) continue;
      result_.relaxations.push_back(relaxation_of(what, what.value(amount)));
      return;
    }
  }

  // ---- a duration that is too short ----

  void explain_duration() {
    const double allowed = problem_.duration.max;
    const double needed = rounded_up((certified_ ? 1 : 1 + kMargin) * shortest());
    result_.shortest_duration = needed;
    const std::string where = allowed == kLongestByDefault ? " where nothing else is said" : "";
    result_.sentence = fmt::format(
        "duration: at most {:.6g} s is allowed{}; the shortest motion found within the limits takes {}{:.4f} s",
        allowed, where, certified_ ? "" : "about ", needed);
    if (!certified_) result_.sentence += ", as far as was planned: not exact enough to be certified yet";
    const double rows = needed / problem_.longest_sample_period;
    if (rows > static_cast<double>(kMaxRows)) {
      result_.sentence += fmt::format(" (with a sample_period of {:.4f} s or more)",
                                      std::ceil(1e4 * needed / static_cast<double>(kMaxRows - kSpareRows)) / 1e4);
    }
    result_.limit = "duration";
    result_.time = allowed;
    if (!any_timed(problem_)) {
      result_.relaxations.push_back(relaxation_of_time(RelaxableKind::kDuration, "duration", allowed, needed));
      result_.relaxations.back().rough = !certified_;
    } else {
      explain_times_as_well();
    }
    const Collocated& fastest = fastest_->solution();
    const std::vector<Guess> hurried{guess_from(fastest.motion, fastest.durations, allowed)};
    bool any = false;
    const std::vector<Candidate> active = active_in(*fastest_);
    for (const Candidate& candidate : active) any = relax(problem_, candidate, hurried) || any;
    if (!any) relax_together(active, hurried);
  }

  // What no single limit does may take both joints' of one quantity, or else all of them.
  void relax_together(const std::vector<Candidate>& single, const std::vector<Guess>& guesses) {
    for (const Candidate& joint1 : single) {
      for (const Candidate& joint2 : single) {
        if (joint1.what.quantity == nullptr || joint1.what.quantity != joint2.what.quantity) continue;
        if (joint1.what.joint != 1 || joint2.what.joint != 2) continue;
        if (relax(problem_, {both_joints(problem_, *joint1.what.quantity), {}, 0}, guesses)) return;
      }
    }
    relax(problem_, {all_limits(problem_), {}, 0}, guesses);
  }

  // The shortest motion passes its via points when it likes: what it takes at the times that were asked for, or which
  // of those would have to change as well.
  void explain_times_as_well() {
    Problem timed = fastest_of(problem_);
    timed.via = problem_.via;
    for (const Via& via : timed.via) timed.duration.min = via.time.value_or(timed.duration.min) + kShortestDuration;
    if (const auto kept = search_.solve(timed, "duration", search_.guesses(timed))) {
      const double needed = rounded_up(kept->solution().motion.duration());
      result_.sentence += fmt::format(", and {:.4f} s with the via points at their times", needed);
      result_.relaxations.push_back(
          relaxation_of_time(RelaxableKind::kDuration, "duration", problem_.duration.max, needed));
      return;
    }
    for (std::size_t i = 0; i < problem_.via.size() && !search_.over(); ++i) {
      const auto asked = problem_.via[i].time;
      const auto earliest = asked ? earliest_at(problem_, i, search_) : std::nullopt;
      if (!earliest || *earliest <= *asked) continue;
      result_.sentence += fmt::format(
          "; via[{}] is to be passed at {:.6g} s, and within the limits it cannot be passed before {:.4f} s", i, *asked,
          rounded_up(*earliest));
      return;
    }
  }

  // ---- via points whose times cannot be kept ----

  void explain_via_times() {
    for (std::size_t i = 0; i < problem_.via.size() && result_.sentence.empty() && !search_.over(); ++i) {
      if (!problem_.via[i].time) continue;
      const double asked = *problem_.via[i].time;
      const auto earliest = earliest_at(problem_, i, search_);
      if (!earliest || *earliest <= asked) continue;
      tell_via(i, fmt::format("within the limits it cannot be passed before {:.4f} s", *earliest));
      if (const auto time = nearest_time(problem_, i, *earliest + kMargin * (*earliest - asked), search_)) {
        move_via(i, *time);
      }
    }
    for (std::size_t i = 0; i < problem_.via.size() && result_.sentence.empty() && !search_.over(); ++i) {
      if (!problem_.via[i].time) continue;
      const auto time = nearest_time(problem_, i, {}, search_);
      if (!time) continue;
      tell_via(i, fmt::format("that leaves too little time {} it", *time > *problem_.via[i].time ? "before" : "after"));
      move_via(i, *time);
    }
  }

  void tell_via(std::size_t i, const std::string& why) {
    const double asked = *problem_.via[i].time;
    result_.sentence = fmt::format("via[{}] is to be passed at {:.6g} s; {}", i, asked, why);
    result_.limit = fmt::format("via[{}].time", i);
    result_.time = asked;
  }

  // Times are found with friction smoothed: what is told is planned, and where it is not enough, with more of it.
  void move_via(std::size_t i, double time) {
    const double asked = *problem_.via[i].time;
    const std::string name = fmt::format("via[{}].time", i);
    Relaxation named = relaxation_of_time(RelaxableKind::kViaTime, name, asked, time);
    for (const double more : kMore) {
      if (search_.over()) break;
      const Relaxation tried = relaxation_of_time(RelaxableKind::kViaTime, name, asked, asked + more * (time - asked));
      Problem moved = problem_;
      moved.via[i].time = tried.to;
      if (!is_enough(moved, name, search_.guesses(moved).front())) continue;
      result_.relaxations.push_back(tried);
      return;
    }
    named.rough = true;
    result_.relaxations.push_back(named);
  }

  // ---- limits that no motion keeps ----

  void explain_limits() {
    if (tell_reached()) return;
    const Problem loose = hurried(with_slack_everywhere(problem_));
    auto everything = search_.sketch(loose, "everything", search_.guesses(relaxed(problem_, kLoose)));
    if (everything && everything->solution().slack < kClose) {  // nearly possible: a sketch cannot tell
      everything = search_.solve(loose, "everything", {guess_of(*everything)});
      if (!everything || is_possible(*everything)) return;
    }
    const Continuation* near = everything ? &*everything : nullptr;
    const std::vector<Guess> from = near != nullptr ? std::vector<Guess>{guess_of(*near)} : search_.guesses(problem_);
    for (const Candidate& candidate : candidates(problem_, near)) {
      if (search_.over() || start_) break;
      relax(problem_, candidate, from);
    }
    if (start_) return;
    if (result_.relaxations.empty() && near != nullptr) relax_together(candidates(problem_, near), from);
    if (result_.relaxations.empty() && near == nullptr) return explain_by_statics();
    std::stable_sort(result_.relaxations.begin(), result_.relaxations.end(), easier);
    name_what_is_in_the_way(near);
  }

  // Where the search came to a motion with one limit relaxed, that is what it takes, about.
  bool tell_reached() {
    if (!reached_) return false;
    for (const Relaxable& what : relaxables(problem_)) {
      if (what.kind != RelaxableKind::kLimit) continue;
      const double limit = kLimitNames[what.indices.front()].in(*reached_);
      if (limit == what.from) continue;
      result_.relaxations.push_back(relaxation_of(what, limit));
      result_.relaxations.back().rough = true;
    }
    if (result_.relaxations.size() != 1) result_.relaxations.clear();
    if (!result_.relaxations.empty()) name_what_is_in_the_way(nullptr);
    return !result_.relaxations.empty();
  }

  static bool easier(const Relaxation& a, const Relaxation& b) {
    const auto change = [](const Relaxation& r) { return std::abs(r.to - r.from) / std::max(std::abs(r.from), 0.1); };
    if (a.rough != b.rough) return b.rough;
    return a.within_robot != b.within_robot ? a.within_robot : change(a) < change(b);
  }

  void name_what_is_in_the_way(const Continuation* everything) {
    bool velocity = false;
    if (!result_.relaxations.empty()) {
      const Relaxation& first = result_.relaxations.front();
      if (first.kind == RelaxableKind::kAllLimits) {  // nothing single
        result_.sentence = "no motion found keeps every limit";
        return;
      }
      result_.limit = first.name;
      result_.joint = first.joint;
      result_.quantity = first.quantity;
      result_.time = first.time;
      velocity = first.kind == RelaxableKind::kVelocity;
    } else {
      for (const Candidate& worst : candidates(problem_, everything)) {
        if (!result_.limit.empty()) break;
        result_.limit = worst.what.name;
        result_.joint = worst.what.joint;
        result_.quantity = worst.what.quantity;
        velocity = worst.what.kind == RelaxableKind::kVelocity;
      }
    }
    const std::string when = result_.time ? fmt::format(" at {:.3f} s", *result_.time) : "";
    result_.sentence =
        velocity ? fmt::format("no motion found within the limits moves as fast as {} asks for", result_.limit)
                 : fmt::format("no motion found keeps every limit; {} is in the way{}",
                               name_of(result_.limit, result_.joint), when);
    add_statics();
    if (result_.relaxations.empty() && everything != nullptr) {
      result_.sentence +=
          fmt::format("; all limits together {:.3g} times as large would do", 1 + everything->solution().slack);
    }
  }

  // ---- statics ----

  // Where carrying the arm slowly takes more than the limit that is in the way.
  void add_statics() {
    if (result_.joint == 0 || result_.quantity == nullptr) return;
    const auto j = static_cast<std::size_t>(result_.joint - 1);
    const Carrying needs = carrying(problem_);
    const double needed = needs.of(*result_.quantity, j);
    if (needed <= (problem_.limits.*result_.quantity->per_joint)[j]) return;
    result_.sentence += fmt::format(" (held still on the straight way, at [{:.3g}, {:.3g}] rad, it takes {:.4g} {})",
                                    needs.posture[j][0], needs.posture[j][1], needed, result_.quantity->unit);
  }

  // Where not even a motion with everything relaxed is found: what cannot be carried slowly.
  void explain_by_statics() {
    const Carrying needs = carrying(problem_);
    for (std::size_t j = 0; j < kJoints && result_.limit.empty(); ++j) {
      for (const QuantityInfo* quantity : {&Torque::info, &SpringDeflection::info}) {
        if (needs.of(*quantity, j) <= (problem_.limits.*quantity->per_joint)[j]) continue;
        result_.limit = quantity->name;
        result_.joint = static_cast<int>(j) + 1;
        result_.quantity = quantity;
      }
    }
    if (result_.limit.empty()) return;
    result_.sentence =
        fmt::format("no motion within the limits was found; {} is in the way", name_of(result_.limit, result_.joint));
    add_statics();
  }

  // ---- telling ----

  void add_relaxations_to_sentence() {
    bool any = false;
    for (const Relaxation& r : result_.relaxations) {
      if (r.kind == RelaxableKind::kDuration) continue;
      any = true;
      result_.sentence += "; " + sentence_of(r);
    }
    if (!any && !search_.over()) result_.sentence += "; no other change of a single limit was found to do";
  }

  const Problem& problem_;
  const Continuation* fastest_;
  const bool certified_;  // the fastest
  const std::optional<Limits> reached_;
  Search search_;
  Infeasibility result_;
  std::optional<Guess> start_;  // of a motion for the request, which turned out to be possible
};

}  // namespace

WhyNot explain(const Problem& problem, const Continuation* fastest, bool certified,
               const std::optional<Limits>& reached, Session& session) {
  return Explanation(problem, fastest, certified, reached, session).run();
}

}  // namespace fjr
