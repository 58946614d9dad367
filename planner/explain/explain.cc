#include "planner/explain/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "planner/analysis/analysis.h"
#include "planner/collocation/detours.h"
#include "planner/collocation/margins.h"
#include "planner/explain/search.h"
#include "planner/explain/slack.h"
#include "planner/explain/statics.h"
#include "planner/problem/relaxable.h"

namespace fjr {
namespace {

constexpr std::size_t kMostCandidates = 4;  // things to relax that are looked at, velocities apart
constexpr double kRoom = 0.01;      // share of a change added to it: right at the edge there is one motion, and no plan
constexpr double kGridRoom = 1.1;   // times the room that a grid found missing
constexpr double kPossible = 2e-3;  // slack below which the request is possible, as far as can be told
constexpr double kInTheWay = 0.05;  // share of the slack by which what is in the way exceeds its limit
constexpr double kLoose = 3;        // share by which limits are relaxed for a duration to start from
constexpr double kLonger = 2;       // times the duration of a hurried motion that the least change may take
constexpr double kTimeStep = 0.02;  // share of a change of time to which it is found

// Something to relax, with when it is in the way.
struct Candidate {
  Relaxable what;
  std::optional<double> time;  // [s]
  double weight = 0;           // how much it is in the way, compared to others
};

void keep_heaviest(std::vector<Candidate>& candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.weight > b.weight; });
  if (candidates.size() > kMostCandidates) candidates.resize(kMostCandidates);
}

bool is_velocity(const Relaxable& what) { return what.unit == "times"; }

std::string name_of(const std::string& name, int joint) {
  return joint == 0 ? name : fmt::format("{} of joint {}", name, joint);
}

class Explanation {
 public:
  Explanation(const Problem& problem, const Continuation* fastest, const SolveTools& tools)
      : problem_(problem), fastest_(fastest), search_(tools) {}

  std::optional<Infeasibility> run() {
    if (const NoWay barred = no_way(problem_); !barred.sentence.empty()) {
      explain_barred(barred);
    } else if (fastest_ != nullptr && shortest() > problem_.duration.max) {
      explain_duration();
    } else {
      if (fastest_ != nullptr) result_.shortest_duration = shortest();
      explain_via_times();
      if (result_.sentence.empty() && (fastest_ == nullptr || timed())) explain_limits();
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

  // The least change of this one thing that makes the problem possible, from these guesses.
  bool relax(const Problem& problem, const Candidate& candidate, const std::vector<Guess>& guesses) {
    const Problem elastic = with_slack(problem, candidate.what);
    const auto solution = least(elastic, name_of(candidate.what.name, candidate.what.joint), guesses);
    if (!solution) return false;
    const double slack = (1 + kRoom) * solution->solution().slack;
    if (slack > elastic.elastic->most) return false;
    const Relaxable& what = candidate.what;
    const double to = value_with(problem, what, slack);
    const auto time = candidate.time ? candidate.time : worst_moment(problem, what, solution->solution()).time;
    result_.relaxations.push_back(
        {what.name, what.joint, what.unit, what.from, to, std::abs(to - what.from) <= what.allowed, time});
    return true;
  }

  // Where there is time, first in a hurry, and then with as much more of it as the mesh has room for.
  std::optional<Continuation> least(Problem elastic, const std::string& what, std::vector<Guess> guesses) {
    Duration& duration = elastic.duration;
    const double soon = kLonger * guesses.front().duration();
    if (!timed() && duration.max > std::max(soon, duration.min)) {
      const auto first = search_.sketch(hurried(elastic), what + ", hurried", guesses);
      if (!first) return std::nullopt;
      guesses = {guess_of(*first)};
      duration.max = std::clamp(kLonger * guesses.front().duration(), duration.min, duration.max);
    }
    return search_.solve(elastic, what, guesses);
  }

  // By how much, as a share of its size, and when that motion exceeds the limit most.
  static Candidate worst_moment(const Problem& problem, const Relaxable& what, const Collocated& solution) {
    const auto excess = excesses(problem, solution.setup.mesh, solution.motion);
    const PerLimit scales = limit_scales(problem);
    Candidate worst{what, {}, 0};
    for (int joint = 0; joint <= kJoints; ++joint) {
      if (what.joint != 0 && joint != what.joint) continue;
      for (const std::size_t i : indices_of(problem, what.name, joint)) {
        for (std::size_t k = 0; k < excess.size(); ++k) {
          if (!(excess[k][i] / scales[i] > worst.weight)) continue;
          worst.weight = excess[k][i] / scales[i];
          worst.time = solution.motion.intervals[k].start;
        }
      }
    }
    return worst;
  }

  // ---- no way round ----

  void explain_barred(const NoWay& barred) {
    result_.sentence = barred.sentence;
    if (!barred.names.empty()) result_.limit = barred.names.front();
    for (const Relaxable& what : relaxables(problem_)) {
      if (std::count(barred.names.begin(), barred.names.end(), what.name) > 0) make_room(what, barred.missing);
    }
  }

  // A slack finds ways between the collocation points where there is none; the grid does not.
  void make_room(const Relaxable& what, double missing) {
    const double amount = kGridRoom * missing;
    if (missing == 0 || amount >= what.most) return;
    const Problem roomier = what.relaxed(problem_, amount);
    if (!no_way(roomier).sentence.empty()) return;
    if (!search_.solve(roomier, what.name, search_.guesses(roomier))) return;
    result_.relaxations.push_back({what.name, what.joint, what.unit, what.from, what.value(amount), true, {}});
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
    const Collocated& fastest = fastest_->solution();
    const std::vector<Guess> hurried{guess_from(fastest.motion, fastest.durations, allowed)};
    bool any = false;
    for (const Candidate& candidate : active_in_fastest()) any = relax(problem_, candidate, hurried) || any;
    if (!any) relax(problem_, {all_limits(problem_), {}, 0}, hurried);
  }

  // What the fastest motion is limited by, what helps most first.
  std::vector<Candidate> active_in_fastest() const {
    const Analysis analysis = analyse(fastest_->problem(), fastest_->solution(), 1);
    std::vector<Candidate> candidates;
    for (const Relaxable& what : relaxables(problem_)) {
      Candidate candidate{what, {}, 0};
      double longest = 0;
      for (const LimitWorth& limit : analysis.sensitivity.limits) {
        const bool same = limit.name == what.name && (what.joint == 0 || limit.joint == what.joint);
        if (!same || limit.worth <= 0) continue;
        candidate.weight += limit.worth * size_of(what);
        for (const auto& stretch : limit.active) {
          if (stretch.end - stretch.begin <= longest) continue;
          longest = stretch.end - stretch.begin;
          candidate.time = (stretch.begin + stretch.end) / 2;
        }
      }
      if (candidate.weight > 0) candidates.push_back(candidate);
    }
    keep_heaviest(candidates);
    return candidates;
  }

  // ---- via points whose times cannot be kept ----

  void explain_via_times() {
    for (std::size_t i = 0; i < problem_.via.size() && result_.sentence.empty() && !search_.over(); ++i) {
      if (!problem_.via[i].time || problem_.task.path) continue;
      const std::string name = fmt::format("via[{}].time", i);
      const Problem hurry = up_to(i);
      const auto earliest = search_.solve(hurry, name, search_.guesses(hurry));
      const double asked = *problem_.via[i].time;
      if (!earliest || earliest->solution().motion.duration() <= asked) continue;
      const double time = earliest->solution().motion.duration();
      result_.sentence = fmt::format(
          "via[{}] is to be passed at {:.6g} s; within the limits it cannot be passed before "
          "{:.4f} s",
          i, asked, time);
      result_.limit = name;
      result_.time = asked;
      move_via(i, time + kRoom * (time - asked));
    }
    for (std::size_t i = 0; i < problem_.via.size() && result_.sentence.empty() && !search_.over(); ++i) {
      if (!problem_.via[i].time || !move_via(i, {})) continue;
      const Relaxation& moved = result_.relaxations.back();
      result_.sentence = fmt::format("via[{}] is to be passed at {:.6g} s, which leaves too little time {} it", i,
                                     moved.from, moved.to > moved.from ? "before" : "after");
      result_.limit = moved.name;
      result_.time = moved.from;
    }
  }

  // The fastest motion through via point i, to end there.
  Problem up_to(std::size_t i) const {
    Problem result = problem_;
    const Via& via = problem_.via[i];
    result.goal = Goal{};
    result.goal.q = via.q;
    result.goal.dq = via.dq.value_or(Pair<double>{});
    result.goal.dq_free = !via.dq;
    result.goal.at_rest = false;
    result.other_goals.clear();
    result.release.reset();
    result.via.erase(result.via.begin() + static_cast<std::ptrdiff_t>(i), result.via.end());
    const double before = i > 0 ? result.via.back().time.value_or(0) : 0;
    result.duration = {before + kShortestDuration, kLongestDuration};
    result.weights = {.time = 1};
    return result;
  }

  // The time of via point i alone, moved as little as leaves the rest of the request possible; `least`: known to be the
  // least, if it is enough. False when it does not help.
  bool move_via(std::size_t i, std::optional<double> least) {
    Problem moved = problem_;
    moved.weights = fastest_ != nullptr ? fastest_->problem().weights : Weights{.time = 1};
    const std::string name = fmt::format("via[{}].time", i);
    const double asked = *problem_.via[i].time;
    const auto add = [&](double time) {
      result_.relaxations.push_back({name, 0, "s", asked, time, true, asked});
      return true;
    };
    if (least) {
      moved.via[i].time = least;
      if (search_.sketch(moved, name, search_.guesses(moved))) return add(*least);
    }
    moved.via[i].time.reset();
    auto possible = search_.sketch(moved, name, search_.guesses(moved));
    if (!possible) return false;
    const auto& durations = possible->solution().durations;
    double wrong = asked,
           right = std::accumulate(durations.begin(), durations.begin() + static_cast<std::ptrdiff_t>(i) + 1, 0.0);
    while (std::abs(right - wrong) > kTimeStep * std::abs(right - asked) && !search_.over()) {
      moved.via[i].time = (wrong + right) / 2;
      auto next = search_.sketch(moved, name, {guess_of(*possible)});
      (next ? right : wrong) = *moved.via[i].time;
      if (next) possible = std::move(next);
    }
    return add(right);
  }

  // ---- limits that no motion keeps ----

  void explain_limits() {
    const Problem loose = hurried(with_slack_everywhere(problem_));
    const auto everything = search_.sketch(loose, "everything", search_.guesses(relaxed(problem_, kLoose)));
    if (everything && everything->solution().slack < kPossible) return;
    const std::vector<Guess> from = everything ? std::vector<Guess>{guess_of(*everything)} : search_.guesses(problem_);
    for (const Candidate& candidate : candidates(everything ? &*everything : nullptr)) {
      if (search_.over()) break;
      relax(problem_, candidate, from);
    }
    if (result_.relaxations.empty() && everything) relax(problem_, {all_limits(problem_), {}, 0}, from);
    if (result_.relaxations.empty() && !everything) return explain_by_statics();
    std::stable_sort(result_.relaxations.begin(), result_.relaxations.end(), easier);
    name_what_is_in_the_way(everything ? &*everything : nullptr);
  }

  // What exceeds its limit with everything relaxed, what exceeds it most first; then velocities.
  std::vector<Candidate> candidates(const Continuation* everything) const {
    std::vector<Candidate> found, velocities;
    for (const Relaxable& what : relaxables(problem_)) {
      if (is_velocity(what)) {
        velocities.push_back({what, {}, 0});
      } else if (everything) {
        Candidate candidate = worst_moment(problem_, what, everything->solution());
        if (candidate.weight <= kInTheWay * everything->solution().slack) continue;
        candidate.weight += short_of_carrying(what);
        candidate.time.reset();  // that was of another motion
        found.push_back(candidate);
      }
    }
    keep_heaviest(found);
    velocities.insert(velocities.end(), found.begin(), found.end());
    return velocities;
  }

  // By how much the limit is below what carrying the arm slowly takes, as a share of the limit.
  double short_of_carrying(const Relaxable& what) const {
    if (what.joint == 0) return 0;
    const Carrying needs = carrying(problem_);
    const auto j = static_cast<std::size_t>(what.joint - 1);
    const double needed = what.name == "torque"              ? needs.torque[j]
                          : what.name == "spring_deflection" ? needs.deflection[j]
                                                             : 0;
    return std::max(0.0, needed / what.from - 1);
  }

  static bool easier(const Relaxation& a, const Relaxation& b) {
    const auto change = [](const Relaxation& r) { return std::abs(r.to - r.from) / std::max(std::abs(r.from), 0.1); };
    return a.within_robot != b.within_robot ? a.within_robot : change(a) < change(b);
  }

  void name_what_is_in_the_way(const Continuation* everything) {
    if (!result_.relaxations.empty()) {
      const Relaxation& first = result_.relaxations.front();
      result_.limit = first.name;
      result_.joint = first.joint;
      result_.time = first.time;
    } else {
      std::vector<Candidate> worst = candidates(everything);
      keep_heaviest(worst);
      result_.limit = worst.front().what.name;
      result_.joint = worst.front().what.joint;
    }
    const std::string when = result_.time ? fmt::format(" at {:.3f} s", *result_.time) : "";
    result_.sentence =
        result_.limit.ends_with(".dq")
            ? fmt::format("no motion found within the limits moves as fast as {} asks for", result_.limit)
            : fmt::format("no motion found keeps every limit; {} is in the way{}",
                          name_of(result_.limit, result_.joint), when);
    add_statics();
    if (result_.relaxations.empty() && everything != nullptr) {
      result_.sentence +=
          fmt::format("; all limits together {:.3g} times as large would do", 1 + everything->solution().slack);
    }
  }

  // ---- statics ----

  void add_statics() {
    const Carrying needs = carrying(problem_);
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (result_.joint != static_cast<int>(j) + 1) continue;
      if (result_.limit == "torque" && needs.torque[j] > problem_.limits.torque[j]) add_carrying(needs, j);
      if (result_.limit == "spring_deflection" && needs.deflection[j] > problem_.limits.spring_deflection[j]) {
        add_carrying(needs, j);
      }
    }
  }

  void add_carrying(const Carrying& needs, std::size_t j) {
    const bool torque = result_.limit == "torque";
    result_.sentence += fmt::format(" (held still on the straight way, at [{:.3g}, {:.3g}] rad, it takes {:.4g} {})",
                                    needs.posture[j][0], needs.posture[j][1],
                                    torque ? needs.torque[j] : needs.deflection[j], torque ? "N m" : "rad");
  }

  // Where not even a motion with everything relaxed is found: what cannot be carried slowly.
  void explain_by_statics() {
    const Carrying needs = carrying(problem_);
    const Limits& limits = problem_.limits;
    for (std::size_t j = 0; j < kJoints && result_.limit.empty(); ++j) {
      result_.joint = static_cast<int>(j) + 1;
      if (needs.torque[j] > limits.torque[j]) result_.limit = "torque";
      if (needs.deflection[j] > limits.spring_deflection[j]) result_.limit = "spring_deflection";
    }
    if (result_.limit.empty()) return;
    result_.sentence =
        fmt::format("no motion within the limits was found; {} is in the way", name_of(result_.limit, result_.joint));
    add_statics();
  }

  // ---- telling ----

  void add_relaxations_to_sentence() {
    std::string& text = result_.sentence;
    bool any = false;
    for (const Relaxation& r : result_.relaxations) {
      if (r.name == "duration") continue;
      const std::string unit = r.unit == "times" ? " of what it is" : " " + r.unit;
      const std::string beyond = r.within_robot ? "" : ", more than the robot's";
      any = true;
      if (r.name == "all_limits") {
        text += fmt::format("; no single limit alone would do, but all together {:.4g} times as large{}", r.to, beyond);
      } else if (r.name == "tip_box") {
        text += fmt::format("; tip_box alone would have to be {:.4g} m larger on every side", r.to);
      } else {
        text += fmt::format("; {} alone would have to be {:.4g}{} (now {:.4g}{})", name_of(r.name, r.joint), r.to, unit,
                            r.from, beyond);
      }
    }
    if (!any && !search_.over()) text += "; no other change of a single limit was found to do";
  }

  const Problem& problem_;
  const Continuation* fastest_;
  Search search_;
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
