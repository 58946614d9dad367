#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "planner/problem/relaxable.h"
#include "planner/problem/statics.h"
#include "planner/search/explain/reasons.h"
#include "planner/search/explain/relaxing.h"
#include "planner/search/slack.h"

namespace fjr {
namespace {

// Returns whether the solution has no slack and thus is a start for the request itself.
bool is_possible(Explanation& e, const Continuation& solution) {
  if (solution.solution().slack >= e.settings().negligible_slack || e.known.start_failed) return false;
  e.start = guess_of(solution);
  return true;
}

// Adds what holding the arm takes, if that is more than the limit that is in the way.
void add_statics(Explanation& e) {
  if (e.result.joint == 0 || e.result.quantity == nullptr) return;
  const auto j = static_cast<std::size_t>(e.result.joint - 1);
  const Carrying needs = carrying(e.problem);
  const double needed = e.result.quantity->in(needs.needed, j);
  if (needed <= (e.problem.limits.*e.result.quantity->per_joint)[j]) return;
  e.result.sentence +=
      fmt::format(" (holding the arm still on the straight path, at [{:.3g}, {:.3g}] rad, takes {:.4g} {})",
                  needs.posture[j][0], needs.posture[j][1], needed, e.result.quantity->unit);
}

// If not even a motion with everything relaxed was found, names a limit that is too small for carrying the arm
// slowly.
void explain_by_statics(Explanation& e) {
  const Limits needed = carrying(e.problem).needed;
  for (const int joint : {1, 2}) {
    for (const LimitName& limit : kLimitNames) {
      if (!e.result.limit.empty() || limit.joint != joint || limit.in(needed) <= limit.in(e.problem.limits)) continue;
      e.result.limit = limit.quantity->name;
      e.result.joint = joint;
      e.result.quantity = limit.quantity;
    }
  }
  if (e.result.limit.empty()) return;
  e.result.sentence =
      fmt::format("no motion within the limits was found; {} is in the way", name_of(e.result.limit, e.result.joint));
  add_statics(e);
}

bool easier(const Relaxation& a, const Relaxation& b) {
  const auto change = [](const Relaxation& r) {
    return std::abs(r.to - r.from) / std::max(std::abs(r.from), kLeastSize);
  };
  if (a.rough != b.rough) return b.rough;
  return a.within_robot != b.within_robot ? a.within_robot : change(a) < change(b);
}

void name_what_is_in_the_way(Explanation& e, const Continuation* everything) {
  bool velocity = false;
  if (!e.result.relaxations.empty()) {
    const Relaxation& first = e.result.relaxations.front();
    if (first.kind == RelaxableKind::kAllLimits) {  // nothing single
      e.result.sentence = "no motion found keeps every limit";
      return;
    }
    e.result.limit = first.name;
    e.result.joint = first.joint;
    e.result.quantity = first.quantity;
    e.result.time = first.time;
    velocity = first.kind == RelaxableKind::kVelocity;
  } else {
    std::vector<Candidate> all = candidates(e.problem, everything, e.settings());
    const auto is_velocity = [](const Candidate& c) { return c.what.kind == RelaxableKind::kVelocity; };
    // Velocities stand first whether they are in the way or not.
    if (e.known.out_of_reach != OutOfReach::kVelocity)
      std::stable_partition(all.begin(), all.end(), std::not_fn(is_velocity));
    if (!all.empty()) {
      const Candidate& worst = all.front();
      e.result.limit = worst.what.name;
      e.result.joint = worst.what.joint;
      e.result.quantity = worst.what.quantity;
      velocity = is_velocity(worst);
    }
  }
  if (e.result.limit.empty()) {
    e.result.sentence = "no motion found keeps every limit";
    return;
  }
  const std::string when = e.result.time ? fmt::format(" at {:.3f} s", *e.result.time) : "";
  e.result.sentence =
      velocity ? fmt::format("no motion found within the limits moves as fast as {} asks for", e.result.limit)
               : fmt::format("no motion found keeps every limit; {} is in the way{}",
                             name_of(e.result.limit, e.result.joint), when);
  add_statics(e);
}

// If the search found a motion with one limit relaxed, reports that limit as about what it takes.
bool tell_reached(Explanation& e) {
  if (!e.known.reached) return false;
  for (const Relaxable& what : relaxables(e.problem)) {
    if (what.kind != RelaxableKind::kLimit) continue;
    const double limit = kLimitNames[what.indices.front()].in(*e.known.reached);
    if (limit == what.from) continue;
    e.result.relaxations.push_back(relaxation_of(what, limit));
    e.result.relaxations.back().rough = true;
  }
  if (e.result.relaxations.size() != 1) e.result.relaxations.clear();
  if (!e.result.relaxations.empty()) name_what_is_in_the_way(e, nullptr);
  return !e.result.relaxations.empty();
}

// If velocities are known to be out of reach, relaxes only these, because limits that let the arm move so fast are
// far beyond the robot's.
bool tell_velocities(Explanation& e) {
  if (e.known.out_of_reach != OutOfReach::kVelocity) return false;
  if (!relax_each(e, candidates(e.problem, nullptr, e.settings()), e.search.guesses(e.problem))) return false;
  std::stable_sort(e.result.relaxations.begin(), e.result.relaxations.end(), easier);
  name_what_is_in_the_way(e, nullptr);
  return true;
}

}  // namespace

void explain_limits(Explanation& e) {
  if (tell_reached(e) || tell_velocities(e)) return;
  const SlackSettings& slack = e.slack_settings();
  const Problem loose = with_larger_time_weight(with_slack_everywhere(e.problem, slack), slack);
  auto everything = e.search.sketch(loose, "everything", e.search.guesses(relaxed(e.problem, slack.loose)));
  const bool nearly_possible = everything && everything->solution().slack < e.settings().slack_worth_exact_friction;
  if (nearly_possible) {  // a sketch cannot tell
    auto exact = e.search.solve(loose, "everything", {guess_of(*everything)});
    if (exact && is_possible(e, *exact)) return;
    if (!exact && !e.known.start_failed) return;
    if (exact) everything = std::move(exact);
  }
  const Continuation* near = everything ? &*everything : nullptr;
  const std::vector<Guess> from = near != nullptr ? std::vector<Guess>{guess_of(*near)} : e.search.guesses(e.problem);
  std::vector<Candidate> single = candidates(e.problem, near, e.settings());
  const auto limits = std::stable_partition(single.begin(), single.end(),
                                            [](const Candidate& c) { return c.what.kind == RelaxableKind::kVelocity; });
  std::vector<Candidate> others(limits, single.end());
  single.erase(limits, single.end());
  if (relax_each(e, single, from) && near != nullptr) keep_within_robot(others, near->solution().slack);
  if (!e.start) relax_each(e, others, from);
  if (e.start) return;
  if (e.result.relaxations.empty() && near != nullptr) {
    relax_together(e, candidates(e.problem, near, e.settings()), from);
  }
  if (e.result.relaxations.empty() && near == nullptr) return explain_by_statics(e);
  std::stable_sort(e.result.relaxations.begin(), e.result.relaxations.end(), easier);
  name_what_is_in_the_way(e, near);
}

}  // namespace fjr
