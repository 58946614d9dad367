#include "planner/search/explain/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/problem/relaxable.h"
#include "planner/problem/statics.h"
#include "planner/search/detours.h"
#include "planner/search/explain/candidates.h"
#include "planner/search/explain/via_times.h"
#include "planner/search/fastest.h"
#include "planner/search/search.h"
#include "planner/search/slack.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

// Fractions of a change that are added to it: with the least change alone there is just one motion, and no plan.
constexpr double kRelaxationMargin = 0.01;
constexpr double kRoughMargin = 0.1;               // if friction is still smoothed
constexpr double kCombinedRelaxationMargin = 0.1;  // of two changes that together are only just enough
constexpr double kGridMargin = 1.1;                // times the clearance that a grid found missing
constexpr double kDurationMargin = 2e-4;           // fraction of a shortest duration
constexpr double kSpareTime = 0.01;                // likewise, beyond it, for objectives other than time
constexpr std::size_t kRowsBetweenRegularOnes = 1000;
// Factors on the least change, tried in this order until planning succeeds.
constexpr double kRetryFactors[] = {1, 1.03, 1.1, 1.25, 1.5, 2};
constexpr double kTrialFractions[] = {0.02, 0.05, 0.1};  // of what is changed
constexpr double kSlackWorthExactFriction = 0.05;  // slack of a sketch below which a more exact solution may need none
constexpr double kNegligibleSlack = 2e-3;          // below it the request is possible, as far as a sketch can tell
constexpr double kSlackBeyondSingleLimits = 0.25;  // fraction of all limits at once
constexpr std::size_t kCandidatesAtATime = 2;      // that are tried beside each other
constexpr double kDurationFactor = 2;              // times the duration of a solution with more weight on time

class Explanation {
 public:
  Explanation(const Problem& problem, const Known& known, Session& session)
      : problem_(problem), known_(known), session_(session), search_(session) {}

  WhyNot run() {
    if (const auto barred = no_path(problem_)) {
      explain_barred(*barred);
    } else if (known_.fastest != nullptr && shortest() > problem_.duration.max) {
      explain_duration();
    } else {
      if (known_.fastest != nullptr) result_.shortest_duration = rounded_up(shortest());
      if (known_.out_of_reach != OutOfReach::kVelocity) explain_via_times();
      const bool told = start_ || !result_.sentence.empty();
      if (!told && (known_.fastest == nullptr || any_timed(problem_))) explain_limits();
    }
    if (start_) return {{}, start_};
    if (result_.sentence.empty()) return {};
    add_relaxations_to_sentence();
    return {result_, {}};
  }

 private:
  double shortest() const { return known_.fastest->solution().motion.duration(); }

  // Returns the shortest duration as it is reported: rounded up and with a little to spare, so that a request for it
  // has a plan.
  static double rounded_up(double duration) { return std::ceil(1e4 * (1 + kDurationMargin) * duration) / 1e4; }

  // Result of relaxing one thing.
  struct Relaxed {
    std::optional<Relaxation> enough;
    std::optional<Guess> start;  // of a motion for the request itself, without relaxing anything
  };

  // Relaxes each of these alone, from these guesses, and keeps the changes that are enough. Returns whether any is. Two
  // at a time are relaxed, each with half of the work that is left, so that together they take no more than there is.
  bool relax_each(const std::vector<Candidate>& candidates, const std::vector<Guess>& guesses) {
    bool any = false;
    for (std::size_t first = 0; first < candidates.size() && !search_.over() && !start_; first += kCandidatesAtATime) {
      anything_tried_ = true;
      std::vector<Relaxed> relaxed(std::min(kCandidatesAtATime, candidates.size() - first));
      const double budget = search_.left() / static_cast<double>(relaxed.size());
      const std::vector<PieceOfWork> pieces = session_.do_all(relaxed.size(), [&](std::size_t i, Session& own) {
        Search search(own, budget);
        relaxed[i] = relax(candidates[first + i], guesses, search);
      });
      for (std::size_t i = 0; i < relaxed.size(); ++i) {
        any = (pieces[i] == PieceOfWork::kCounts && keep(relaxed[i])) || any;
      }
    }
    return any;
  }

  // Keeps a result. Returns whether the change is enough.
  bool keep(const Relaxed& relaxed) {
    if (relaxed.start && !start_) start_ = relaxed.start;
    if (relaxed.enough) result_.relaxations.push_back(*relaxed.enough);
    return relaxed.enough.has_value();
  }

  // Finds the least change of one thing that makes the problem feasible, from these guesses.
  Relaxed relax(const Candidate& candidate, const std::vector<Guess>& guesses, Search& search) const {
    const Problem with_slack_of_it = with_slack(problem_, candidate.what);
    // If the fastest motion was not refined, planning here would take the time that was saved by that.
    const bool too_long_to_plan = known_.fastest != nullptr && !known_.certified;
    // Friction hardly changes how fast a motion can be, and the reported velocity is planned with the exact law anyway.
    const bool sketched = too_long_to_plan || candidate.what.kind == RelaxableKind::kVelocity;
    const std::string name = name_of(candidate.what.name, candidate.what.joint);
    auto solution = least(with_slack_of_it, name, guesses, sketched, search);
    const bool nearly_possible = solution && solution->solution().slack < kSlackWorthExactFriction;
    if (sketched && !too_long_to_plan && nearly_possible) {
      solution = search.solve(with_slack_of_it, name, {guess_of(*solution)});
    }
    const bool rough = !solution || !solution->has_sharpest_friction();
    if (!solution) solution = search.last_sketch();
    if (!solution) return {};
    const Relaxable& what = candidate.what;
    if (solution->solution().slack < kNegligibleSlack && (rough || known_.fastest == nullptr)) {
      if (rough) return {};
      if (known_.start_failed) return {eased(what, guess_of(*solution), search), {}};
      return {{}, guess_of(*solution)};
    }
    const bool planned_soon = sketched && !too_long_to_plan;  // verified() increases it until it is enough
    const double slack = (1 + (rough && !planned_soon ? kRoughMargin : kRelaxationMargin)) * solution->solution().slack;
    if (slack > with_slack_of_it.variation.slack->most) return {};
    Relaxation named = relaxation_of(what, value_with(problem_, what, slack));
    named.rough = rough;
    if (!too_long_to_plan && (what.constraint || ((sketched || !rough) && named.within_robot))) {
      named = verified(what, named, guess_of(*solution), search);
    }
    named.time = candidate.time ? candidate.time : worst_moment(problem_, what, solution->solution());
    return {named, {}};
  }

  // Plans with the change as it is reported, and with larger ones until one is enough. This is necessary because a
  // slack is minimised with rows that hold at the collocation points of a coarse mesh, and between them the motion cuts
  // corners. If none is enough, the change is reported as rough.
  Relaxation verified(const Relaxable& what, Relaxation named, const Guess& near, Search& search) const {
    const double amount = std::abs(named.to - what.from);
    for (const double more : kRetryFactors) {
      if (more * amount > what.most || search.over()) break;
      const Relaxation tried = relaxation_of(what, what.value(more * amount));
      Problem easier = problem_;
      what.set(easier, tried.to);
      if (is_enough(easier, what.name, near, what.kind == RelaxableKind::kVelocity, search)) return tried;
    }
    named.rough = true;
    return named;
  }

  // Returns a change with which planning succeeds, if hardly any is needed and still no plan was found.
  std::optional<Relaxation> eased(const Relaxable& what, const Guess& near, Search& search) const {
    for (const double fraction : kTrialFractions) {
      const double amount = fraction * size_of(what);
      if (amount > what.allowed || known_.fastest != nullptr || search.over()) break;
      const Relaxation tried = relaxation_of(what, what.value(amount));
      Problem easier = problem_;
      what.set(easier, tried.to);
      const Problem quick = any_timed(easier) ? easier : fastest_of(easier);
      if (const auto found = search.plan(quick, what.name, {near}); found && found->duration() <= easier.duration.max)
        return tried;
    }
    return std::nullopt;
  }

  // Returns whether the changed problem has a motion that takes no longer than it may. It is looked for from the usual
  // guesses and from `near`, the motion from which the change was found; near_first: from that one first, because it
  // nearly is a solution.
  static bool is_enough(const Problem& easier, const std::string& what, const Guess& near, bool near_first,
                        Search& search) {
    Problem quick = fastest_of(easier);
    if (any_timed(easier)) {
      quick.via = easier.via;
      quick.duration = easier.duration;
    }
    std::vector<Guess> guesses = search.guesses(quick);
    guesses.insert(near_first ? guesses.begin() : guesses.end(), near);
    const auto found = search.plan(quick, what, guesses);
    return found && (any_timed(easier) || (1 + kDurationMargin) * found->duration() <= easier.duration.max);
  }

  // Returns whether the solution has no slack and thus is a start for the request itself.
  bool is_possible(const Continuation& solution) {
    if (solution.solution().slack >= kNegligibleSlack || known_.start_failed) return false;
    start_ = guess_of(solution);
    return true;
  }

  bool is_possible(const NearestTime& nearest) {
    if (!nearest.as_asked || known_.start_failed) return false;
    start_ = nearest.as_asked;
    return true;
  }

  // Minimises the slack. If the duration is free, a first solution has a large weight of time; then up to twice its
  // duration is allowed, for which the mesh is fine enough, because it takes time to gain speed.
  std::optional<Continuation> least(Problem relaxed, const std::string& what, std::vector<Guess> guesses, bool roughly,
                                    Search& search) const {
    Duration& duration = relaxed.duration;
    const double soon = kDurationFactor * guesses.front().duration();
    if (!any_timed(problem_) && !relaxed.variation.slack->velocity && duration.max > std::max(soon, duration.min)) {
      const auto first = search.sketch(with_larger_time_weight(relaxed), what + ", with more weight on time", guesses,
                                       Search::kMostIterationsOfSlack);
      if (!first) return std::nullopt;
      guesses = {guess_of(*first)};
      duration.max = std::clamp(kDurationFactor * guesses.front().duration(), duration.min, duration.max);
    }
    return roughly ? search.sketch(relaxed, what, guesses, Search::kMostIterationsOfSlack)
                   : search.solve(relaxed, what, guesses, Search::kMostIterationsOfSlack);
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

  // Widens one constraint until there is a path and a motion. The width is taken from the grid, because a problem with
  // a slack can pass through obstacles between the collocation points. More than what is missing [m] is needed between
  // two obstacles, because half of what one gives up is lost to the other one, and where the optimiser finds no motion
  // along a path that is barely open.
  void widen(const Relaxable& what, double missing) {
    if (missing == 0) return;
    for (const double more : {1.0, 1.5, 2.0}) {
      const double amount = more * kGridMargin * missing;
      if (amount >= what.most || search_.over()) return;
      anything_tried_ = true;
      const Problem wider = what.relaxed(problem_, amount);
      if (no_path(wider)) continue;
      if (!search_.solve(wider, what.name, search_.guesses(wider))) continue;
      result_.relaxations.push_back(relaxation_of(what, what.value(amount)));
      return;
    }
  }

  // ---- a duration that is too short ----

  void explain_duration() {
    const double allowed = problem_.duration.max;
    const double needed = rounded_up((known_.certified ? 1 : 1 + kRelaxationMargin) * shortest());
    result_.shortest_duration = needed;
    const std::string where = allowed == kLongestByDefault ? " where nothing else is said" : "";
    result_.sentence = fmt::format(
        "duration: at most {:.6g} s is allowed{}; the shortest motion found within the limits takes {}{:.4f} s",
        allowed, where, known_.certified ? "" : "about ", needed);
    if (!known_.certified) result_.sentence += ", as far as was planned: not exact enough to be certified yet";
    const double rows = needed / problem_.longest_sample_period;
    if (rows > static_cast<double>(kMaxRows)) {
      result_.sentence +=
          fmt::format(" (with a sample_period of {:.4f} s or more)",
                      std::ceil(1e4 * needed / static_cast<double>(kMaxRows - kRowsBetweenRegularOnes)) / 1e4);
    }
    result_.limit = "duration";
    result_.time = allowed;
    if (!any_timed(problem_)) {
      // With hardly more time than the fastest motion takes, other objectives are seldom found.
      const double enough = only_time(problem_.weights) ? needed : rounded_up((1 + kSpareTime) * needed);
      result_.relaxations.push_back(relaxation_of_time(RelaxableKind::kDuration, "duration", allowed, enough));
      result_.relaxations.back().rough = !known_.certified;
    } else if (explain_times_as_well()) {
      return;  // limits that keep both times as they are would have to be far larger, and take long to find
    }
    const Collocated& fastest = known_.fastest->solution();
    const std::vector<Guess> hurried{guess_from(fastest.motion, fastest.durations, allowed)};
    const std::vector<Candidate> active = active_in(*known_.fastest);
    const auto single = worth_trying_alone(active, hurried);
    if (single && !relax_each(*single, hurried)) relax_together(active, hurried);
  }

  // Alone, each limit has to grow by no less than all of them together. Where that is more than a quarter, limits that
  // would then exceed the robot's are not tried: a request may not ask for them, and mostly no motion is found. Nothing
  // where no motion was found even with all of them larger: it is unlikely that one alone does.
  std::optional<std::vector<Candidate>> worth_trying_alone(std::vector<Candidate> single,
                                                           const std::vector<Guess>& guesses) {
    anything_tried_ = true;
    const Problem everything = with_slack(problem_, all_limits(problem_));
    const auto least = search_.sketch(everything, "all_limits", guesses, Search::kMostIterationsOfSlack);
    if (!least) return std::nullopt;
    if (least->solution().slack > kSlackBeyondSingleLimits) keep_within_robot(single, least->solution().slack);
    return single;
  }

  static void keep_within_robot(std::vector<Candidate>& single, double slack) {
    std::erase_if(single, [&](const Candidate& c) { return c.what.allowed < slack * size_of(c.what); });
  }

  // If no single limit is enough, relaxes one quantity of both joints together, or else all limits.
  void relax_together(const std::vector<Candidate>& single, const std::vector<Guess>& guesses) {
    for (const Candidate& joint1 : single) {
      for (const Candidate& joint2 : single) {
        if (joint1.what.quantity == nullptr || joint1.what.quantity != joint2.what.quantity) continue;
        if (joint1.what.joint != 1 || joint2.what.joint != 2) continue;
        if (relax_each({{both_joints(problem_, *joint1.what.quantity), {}, 0}}, guesses)) return;
      }
    }
    relax_each({{all_limits(problem_), {}, 0}}, guesses);
  }

  // Reports how long the shortest motion takes if the via points are passed at the requested times, or which of these
  // would have to change as well; the shortest motion itself ignores them. Returns whether two times that are enough
  // together are reported.
  bool explain_times_as_well() {
    Problem timed = fastest_of(problem_);
    timed.via = problem_.via;
    for (const Via& via : timed.via) timed.duration.min = via.time.value_or(timed.duration.min) + kShortestDuration;
    if (const auto kept = search_.solve(timed, "duration", search_.guesses(timed))) {
      const double needed = rounded_up(kept->solution().motion.duration());
      result_.sentence += fmt::format(", and {:.4f} s with the via points at their times", needed);
      result_.relaxations.push_back(
          relaxation_of_time(RelaxableKind::kDuration, "duration", problem_.duration.max, needed));
      return false;
    }
    for (std::size_t i = 0; i < problem_.via.size() && !search_.over(); ++i) {
      const auto asked = problem_.via[i].time;
      const auto earliest = asked ? earliest_at(problem_, i, search_) : std::nullopt;
      if (!earliest || *earliest <= *asked) continue;
      result_.sentence += fmt::format(
          "; via[{}] is to be passed at {:.6g} s, and within the limits it cannot be passed before {:.4f} s", i, *asked,
          rounded_up(*earliest));
      return tell_both(i, *earliest, *known_.fastest);
    }
    return false;
  }

  // ---- via points whose times cannot be kept ----

  void explain_via_times() {
    for (std::size_t i = 0; i < problem_.via.size() && result_.sentence.empty() && !search_.over(); ++i) {
      if (!problem_.via[i].time) continue;
      const double asked = *problem_.via[i].time;
      const auto earliest = earliest_at(problem_, i, search_);
      if (!earliest || *earliest <= asked) continue;
      tell_via(i, fmt::format("within the limits it cannot be passed before {:.4f} s", *earliest));
      const double enough = *earliest + kRelaxationMargin * (*earliest - asked);
      if (explain_duration_besides(i, enough)) continue;
      anything_tried_ = true;
      const NearestTime nearest = nearest_time(problem_, i, enough, search_);
      if (is_possible(nearest)) return;
      if (nearest.time) move_via(i, *nearest.time);
    }
    for (std::size_t i = 0; i < problem_.via.size() && result_.sentence.empty() && !search_.over(); ++i) {
      if (!problem_.via[i].time) continue;
      anything_tried_ = true;
      const NearestTime nearest = nearest_time(problem_, i, {}, search_);
      if (is_possible(nearest)) return;
      if (!nearest.time) continue;
      const bool later = *nearest.time > *problem_.via[i].time;
      tell_via(i, fmt::format("that leaves too little time {} it", later ? "before" : "after"));
      move_via(i, *nearest.time);
    }
  }

  // If the fastest motion takes longer than is allowed even without the times of via points, reports how long it takes
  // and two times that are enough together. Returns whether that is so.
  bool explain_duration_besides(std::size_t via, double time) {
    const Problem hurry = fastest_of(problem_);
    const auto sketched = search_.sketch(hurry, "duration", search_.guesses(hurry));
    if (!sketched || sketched->duration() <= problem_.duration.max) return false;
    const auto fastest = search_.solve(hurry, "duration", {guess_of(*sketched)});
    if (!fastest || fastest->duration() <= problem_.duration.max) return false;
    result_.shortest_duration = rounded_up((1 + kRelaxationMargin) * fastest->duration());
    result_.sentence += fmt::format(
        "; besides, at most {:.6g} s is allowed for all of the motion, and the shortest takes about {:.4f} s",
        problem_.duration.max, *result_.shortest_duration);
    tell_both(via, time, *fastest);
    return true;
  }

  // Reports a via point's time, from `time` [s] on, and a duration that are enough together if neither can be kept.
  // Both have a little to spare and are verified by planning. Returns false if none are found.
  bool tell_both(std::size_t via, double time, const Continuation& fastest) {
    Problem moved = problem_;
    const double asked = *problem_.via[via].time;
    moved.via[via].time = told(asked, time + kCombinedRelaxationMargin * (time - asked));
    Problem quick = fastest_of(moved);
    quick.via = moved.via;
    for (const Via& v : quick.via) quick.duration.min = v.time.value_or(quick.duration.min) + kShortestDuration;
    const auto both = search_.solve(quick, "duration", {guess_of(fastest)});
    if (!both) return false;
    const double duration = rounded_up((1 + kCombinedRelaxationMargin) * both->duration());
    moved.duration = {duration, duration};
    if (!is_enough(moved, "duration", guess_of(*both), true, search_)) return false;
    result_.sentence += fmt::format("; via[{}].time of {:.4g} s and a duration of {:.4f} s would do together", via,
                                    *moved.via[via].time, duration);
    return true;
  }

  void tell_via(std::size_t i, const std::string& why) {
    const double asked = *problem_.via[i].time;
    result_.sentence = fmt::format("via[{}] is to be passed at {:.6g} s; {}", i, asked, why);
    result_.limit = fmt::format("via[{}].time", i);
    result_.time = asked;
  }

  // Reports a later or earlier time of a via point. It was found with smoothed friction, so it is planned as reported
  // and moved further until that succeeds.
  void move_via(std::size_t i, double time) {
    const double asked = *problem_.via[i].time;
    const std::string name = fmt::format("via[{}].time", i);
    Relaxation named = relaxation_of_time(RelaxableKind::kViaTime, name, asked, time);
    for (const double more : kRetryFactors) {
      if (search_.over()) break;
      const Relaxation tried = relaxation_of_time(RelaxableKind::kViaTime, name, asked, asked + more * (time - asked));
      Problem moved = problem_;
      moved.via[i].time = tried.to;
      if (!is_enough(moved, name, search_.guesses(moved).front(), false, search_)) continue;
      result_.relaxations.push_back(tried);
      return;
    }
    named.rough = true;
    result_.relaxations.push_back(named);
  }

  // ---- limits that no motion keeps ----

  void explain_limits() {
    if (tell_reached() || tell_velocities()) return;
    const Problem loose = with_larger_time_weight(with_slack_everywhere(problem_));
    auto everything = search_.sketch(loose, "everything", search_.guesses(relaxed(problem_, kLoose)));
    if (everything &&
        everything->solution().slack < kSlackWorthExactFriction) {  // nearly possible: a sketch cannot tell
      auto exact = search_.solve(loose, "everything", {guess_of(*everything)});
      if (exact && is_possible(*exact)) return;
      if (!exact && !known_.start_failed) return;
      if (exact) everything = std::move(exact);
    }
    const Continuation* near = everything ? &*everything : nullptr;
    const std::vector<Guess> from = near != nullptr ? std::vector<Guess>{guess_of(*near)} : search_.guesses(problem_);
    std::vector<Candidate> single = candidates(problem_, near);
    const auto limits = std::stable_partition(
        single.begin(), single.end(), [](const Candidate& c) { return c.what.kind == RelaxableKind::kVelocity; });
    std::vector<Candidate> others(limits, single.end());
    single.erase(limits, single.end());
    if (relax_each(single, from) && near != nullptr) keep_within_robot(others, near->solution().slack);
    if (!start_) relax_each(others, from);
    if (start_) return;
    if (result_.relaxations.empty() && near != nullptr) relax_together(candidates(problem_, near), from);
    if (result_.relaxations.empty() && near == nullptr) return explain_by_statics();
    std::stable_sort(result_.relaxations.begin(), result_.relaxations.end(), easier);
    name_what_is_in_the_way(near);
  }

  // If the search found a motion with one limit relaxed, reports that limit as about what it takes.
  bool tell_reached() {
    if (!known_.reached) return false;
    for (const Relaxable& what : relaxables(problem_)) {
      if (what.kind != RelaxableKind::kLimit) continue;
      const double limit = kLimitNames[what.indices.front()].in(*known_.reached);
      if (limit == what.from) continue;
      result_.relaxations.push_back(relaxation_of(what, limit));
      result_.relaxations.back().rough = true;
    }
    if (result_.relaxations.size() != 1) result_.relaxations.clear();
    if (!result_.relaxations.empty()) name_what_is_in_the_way(nullptr);
    return !result_.relaxations.empty();
  }

  // If velocities are known to be out of reach, relaxes only these, because limits that let the arm move so fast are
  // far beyond the robot's.
  bool tell_velocities() {
    if (known_.out_of_reach != OutOfReach::kVelocity) return false;
    if (!relax_each(candidates(problem_, nullptr), search_.guesses(problem_))) return false;
    std::stable_sort(result_.relaxations.begin(), result_.relaxations.end(), easier);
    name_what_is_in_the_way(nullptr);
    return true;
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
    if (result_.limit.empty()) {
      result_.sentence = "no motion found keeps every limit";
      return;
    }
    const std::string when = result_.time ? fmt::format(" at {:.3f} s", *result_.time) : "";
    result_.sentence =
        velocity ? fmt::format("no motion found within the limits moves as fast as {} asks for", result_.limit)
                 : fmt::format("no motion found keeps every limit; {} is in the way{}",
                               name_of(result_.limit, result_.joint), when);
    add_statics();
  }

  // ---- statics ----

  // Adds what holding the arm takes, if that is more than the limit that is in the way.
  void add_statics() {
    if (result_.joint == 0 || result_.quantity == nullptr) return;
    const auto j = static_cast<std::size_t>(result_.joint - 1);
    const Carrying needs = carrying(problem_);
    const double needed = result_.quantity->in(needs.needed, j);
    if (needed <= (problem_.limits.*result_.quantity->per_joint)[j]) return;
    result_.sentence += fmt::format(" (held still on the straight way, at [{:.3g}, {:.3g}] rad, it takes {:.4g} {})",
                                    needs.posture[j][0], needs.posture[j][1], needed, result_.quantity->unit);
  }

  // If not even a motion with everything relaxed was found, names a limit that is too small for carrying the arm
  // slowly.
  void explain_by_statics() {
    const Limits needed = carrying(problem_).needed;
    for (const int joint : {1, 2}) {
      for (const LimitName& limit : kLimitNames) {
        if (!result_.limit.empty() || limit.joint != joint || limit.in(needed) <= limit.in(problem_.limits)) continue;
        result_.limit = limit.quantity->name;
        result_.joint = joint;
        result_.quantity = limit.quantity;
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
    if (!any && anything_tried_ && !search_.over())
      result_.sentence +=
          fmt::format("; no {}change of a single limit was found to do", result_.relaxations.empty() ? "" : "other ");
  }

  const Problem& problem_;
  const Known& known_;
  Session& session_;
  Search search_;
  Infeasibility result_;
  bool anything_tried_ = false;  // whether relaxing anything was tried
  std::optional<Guess> start_;   // of a motion for the request, which turned out to be possible
};

}  // namespace

WhyNot explain(const Problem& problem, const Known& known, Session& session) {
  return Explanation(problem, known, session).run();
}

}  // namespace fjr
