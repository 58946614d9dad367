#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>

#include "planner/problem/relaxable.h"
#include "planner/search/explain/reasons.h"
#include "planner/search/explain/relaxing.h"
#include "planner/search/explain/via_times.h"
#include "planner/search/fastest.h"

namespace fjr {
namespace {

bool is_possible(Explanation& e, const NearestTime& nearest) {
  if (!nearest.as_asked || e.known.start_failed) return false;
  e.start = nearest.as_asked;
  return true;
}

// If the fastest motion takes longer than is allowed even without the times of via points, reports how long it takes
// and two times that are enough together. Returns whether that is so.
bool explain_duration_besides(Explanation& e, std::size_t via, double time) {
  const Problem hurry = fastest_of(e.problem);
  const auto sketched = e.search.sketch(hurry, "duration", e.search.guesses(hurry));
  if (!sketched || sketched->duration() <= e.problem.duration.max) return false;
  const auto fastest = e.search.solve(hurry, "duration", {guess_of(*sketched)});
  if (!fastest || fastest->duration() <= e.problem.duration.max) return false;
  e.result.shortest_duration = e.rounded_up((1 + e.settings().margin) * fastest->duration());
  e.result.sentence +=
      fmt::format("; besides, at most {:.6g} s is allowed for all of the motion, and the shortest takes about {:.4f} s",
                  e.problem.duration.max, *e.result.shortest_duration);
  tell_both(e, via, time, *fastest);
  return true;
}

void tell_via(Explanation& e, std::size_t i, const std::string& why) {
  const double asked = *e.problem.via[i].time;
  e.result.sentence = fmt::format("via[{}] is to be passed at {:.6g} s; {}", i, asked, why);
  e.result.limit = fmt::format("via[{}].time", i);
  e.result.time = asked;
}

// Reports a later or earlier time of a via point. It was found with smoothed friction, so it is planned as reported
// and moved further until that succeeds.
void move_via(Explanation& e, std::size_t i, double time) {
  const double asked = *e.problem.via[i].time;
  const std::string name = fmt::format("via[{}].time", i);
  Relaxation named = relaxation_of_time(RelaxableKind::kViaTime, name, asked, time);
  for (const double more : e.settings().retries) {
    if (e.search.over()) break;
    const Relaxation tried = relaxation_of_time(RelaxableKind::kViaTime, name, asked, asked + more * (time - asked));
    Problem moved = e.problem;
    moved.via[i].time = tried.to;
    if (!is_enough(moved, name, e.search.guesses(moved).front(), false, e.search)) continue;
    e.result.relaxations.push_back(tried);
    return;
  }
  named.rough = true;
  e.result.relaxations.push_back(named);
}

}  // namespace

void explain_via_times(Explanation& e) {
  for (std::size_t i = 0; i < e.problem.via.size() && e.result.sentence.empty() && !e.search.over(); ++i) {
    if (!e.problem.via[i].time) continue;
    const double asked = *e.problem.via[i].time;
    const auto earliest = earliest_at(e.problem, i, e.search);
    if (!earliest || *earliest <= asked) continue;
    tell_via(e, i, fmt::format("within the limits it cannot be passed before {:.4f} s", *earliest));
    const double enough = *earliest + e.settings().margin * (*earliest - asked);
    if (explain_duration_besides(e, i, enough)) continue;
    e.anything_tried = true;
    const NearestTime nearest = nearest_time(e.problem, i, enough, e.search);
    if (is_possible(e, nearest)) return;
    if (nearest.time) move_via(e, i, *nearest.time);
  }
  for (std::size_t i = 0; i < e.problem.via.size() && e.result.sentence.empty() && !e.search.over(); ++i) {
    if (!e.problem.via[i].time) continue;
    e.anything_tried = true;
    const NearestTime nearest = nearest_time(e.problem, i, {}, e.search);
    if (is_possible(e, nearest)) return;
    if (!nearest.time) continue;
    const bool later = *nearest.time > *e.problem.via[i].time;
    tell_via(e, i, fmt::format("that leaves too little time {} it", later ? "before" : "after"));
    move_via(e, i, *nearest.time);
  }
}

bool tell_both(Explanation& e, std::size_t via, double time, const Continuation& fastest) {
  Problem moved = e.problem;
  const double asked = *e.problem.via[via].time;
  moved.via[via].time = told(asked, time + e.settings().combined_margin * (time - asked));
  Problem quick = fastest_of(moved);
  quick.via = moved.via;
  for (const Via& v : quick.via) quick.duration.min = v.time.value_or(quick.duration.min) + kShortestDuration;
  const auto both = e.search.solve(quick, "duration", {guess_of(fastest)});
  if (!both) return false;
  const double duration = e.rounded_up((1 + e.settings().combined_margin) * both->duration());
  moved.duration = {duration, duration};
  if (!is_enough(moved, "duration", guess_of(*both), true, e.search)) return false;
  e.result.sentence += fmt::format("; via[{}].time of {:.4g} s and a duration of {:.4f} s would be enough together",
                                   via, *moved.via[via].time, duration);
  return true;
}

}  // namespace fjr
