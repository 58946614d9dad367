#include "planner/search/explain/relaxing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "planner/problem/relaxable.h"
#include "planner/search/fastest.h"
#include "planner/search/slack.h"

namespace fjr {
namespace {

int iterations_of_slack(const Explanation& e) {
  const ExplanationSolveSettings& s = e.settings().solves;
  return e.is_too_short() ? s.iterations_from_fastest : s.iterations_of_slack;
}

// Minimises the slack. If the duration is free, a first solution has a large weight of time; then a multiple
// of its duration is allowed, for which the mesh is fine enough, because it takes time to gain speed.
std::optional<Continuation> least(const Explanation& e, Problem relaxed, const std::string& what,
                                  std::vector<Guess> guesses, bool roughly, Search& search) {
  Duration& duration = relaxed.duration;
  const double soon = e.slack_settings().longer * guesses.front().duration();
  if (!any_timed(e.problem) && !relaxed.variation.slack->velocity && duration.max > std::max(soon, duration.min)) {
    const auto first =
        search.sketch(with_larger_time_weight(relaxed, e.slack_settings()), what + ", with more weight on time",
                      guesses, e.settings().solves.iterations_of_slack);
    if (!first) return std::nullopt;
    guesses = {guess_of(*first)};
    duration.max = std::clamp(e.slack_settings().longer * guesses.front().duration(), duration.min, duration.max);
  }
  return roughly ? search.sketch(relaxed, what, guesses, iterations_of_slack(e))
                 : search.solve(relaxed, what, guesses, iterations_of_slack(e));
}

// Result of relaxing one thing.
struct Relaxed {
  std::optional<Relaxation> enough;
  std::optional<Guess> start;  // of a motion for the request itself, without relaxing anything
};

// Keeps a result. Returns whether the change is enough.
bool keep(Explanation& e, const Relaxed& relaxed) {
  if (relaxed.start && !e.start) e.start = relaxed.start;
  if (relaxed.enough) e.result.relaxations.push_back(*relaxed.enough);
  return relaxed.enough.has_value();
}

// Plans with the change as it is reported, and with larger ones until one is enough. This is necessary because a
// slack is minimised with rows that hold at the collocation points of a coarse mesh, and between them the motion cuts
// corners. If none is enough, the change is reported as rough.
Relaxation verified(const Explanation& e, const Relaxable& what, Relaxation named, const Guess& near, Search& search) {
  const double amount = std::abs(named.to - what.from);
  for (const double more : e.settings().retries) {
    if (more * amount > what.most || search.over()) break;
    const Relaxation tried = relaxation_of(what, what.value(more * amount));
    Problem easier = e.problem;
    what.set(easier, tried.to);
    if (is_enough(easier, what.name, near, what.kind == RelaxableKind::kVelocity, search)) return tried;
  }
  named.rough = true;
  return named;
}

// Returns a change with which planning succeeds, if hardly any is needed and still no plan was found.
std::optional<Relaxation> eased(const Explanation& e, const Relaxable& what, const Guess& near, Search& search) {
  for (const double fraction : e.settings().trials) {
    const double amount = fraction * what.size();
    if (amount > what.allowed || e.known.fastest != nullptr || search.over()) break;
    const Relaxation tried = relaxation_of(what, what.value(amount));
    Problem easier = e.problem;
    what.set(easier, tried.to);
    const Problem quick = any_timed(easier) ? easier : fastest_of(easier);
    if (const auto found = search.plan(quick, what.name, {near}); found && found->duration() <= easier.duration.max)
      return tried;
  }
  return std::nullopt;
}

// Finds the least change of one thing that makes the problem feasible, from these guesses.
Relaxed relax(const Explanation& e, const Candidate& candidate, const std::vector<Guess>& guesses, Search& search) {
  const Problem with_slack_of_it = with_slack(e.problem, candidate.what, e.slack_settings());
  // If the fastest motion was not refined, planning here would take the time that was saved by that.
  const bool too_long_to_plan = e.known.fastest != nullptr && !e.known.certified;
  // Friction hardly changes how fast a motion can be, and the reported velocity is planned with the exact law anyway.
  const bool sketched = too_long_to_plan || candidate.what.kind == RelaxableKind::kVelocity;
  const std::string name = name_of(candidate.what.name, candidate.what.joint);
  auto solution = least(e, with_slack_of_it, name, guesses, sketched, search);
  const bool nearly_possible = solution && solution->solution().slack < e.settings().slack_worth_exact_friction;
  if (sketched && !too_long_to_plan && nearly_possible) {
    solution = search.solve(with_slack_of_it, name, {guess_of(*solution)});
  }
  const bool rough = !solution || !solution->has_sharpest_friction();
  if (!solution) solution = search.last_sketch();
  if (!solution) return {};
  const Relaxable& what = candidate.what;
  if (solution->solution().slack < e.settings().negligible_slack && (rough || e.known.fastest == nullptr)) {
    if (rough) return {};
    if (e.known.start_failed) return {eased(e, what, guess_of(*solution), search), {}};
    return {{}, guess_of(*solution)};
  }
  const bool planned_soon = sketched && !too_long_to_plan;  // verified() increases it until it is enough
  const double margin = rough && !planned_soon ? e.settings().rough_margin : e.settings().margin;
  const double slack = (1 + margin) * solution->solution().slack;
  if (slack > with_slack_of_it.variation.slack->most) return {};
  Relaxation named = relaxation_of(what, value_with(e.problem, what, slack));
  named.rough = rough;
  if (!too_long_to_plan && (what.constraint || ((sketched || !rough) && named.within_robot))) {
    named = verified(e, what, named, guess_of(*solution), search);
  }
  named.time = candidate.time ? candidate.time : worst_moment(e.problem, what, solution->solution());
  return {named, {}};
}

}  // namespace

bool relax_each(Explanation& e, const std::vector<Candidate>& candidates, const std::vector<Guess>& guesses) {
  bool any = false;
  const std::size_t at_a_time = e.settings().candidates_at_a_time;
  for (std::size_t first = 0; first < candidates.size() && !e.search.over() && !e.start; first += at_a_time) {
    e.anything_tried = true;
    std::vector<Relaxed> relaxed(std::min(at_a_time, candidates.size() - first));
    const double budget = e.search.left() / static_cast<double>(relaxed.size());
    const std::vector<PieceOfWork> pieces = e.session.do_all(relaxed.size(), [&](std::size_t i, Session& own) {
      Search search(own, budget);
      relaxed[i] = relax(e, candidates[first + i], guesses, search);
    });
    for (std::size_t i = 0; i < relaxed.size(); ++i) {
      any = (pieces[i] == PieceOfWork::kCounts && keep(e, relaxed[i])) || any;
    }
  }
  return any;
}

void keep_within_robot(std::vector<Candidate>& single, double slack) {
  std::erase_if(single, [&](const Candidate& c) {
    return c.what.kind == RelaxableKind::kLimit && c.what.allowed < slack * c.what.size();
  });
}

void relax_together(Explanation& e, const std::vector<Candidate>& single, const std::vector<Guess>& guesses) {
  for (const Candidate& joint1 : single) {
    for (const Candidate& joint2 : single) {
      if (joint1.what.quantity == nullptr || joint1.what.quantity != joint2.what.quantity) continue;
      if (joint1.what.joint != 1 || joint2.what.joint != 2) continue;
      if (relax_each(e, {{both_joints(e.problem, *joint1.what.quantity), {}, 0}}, guesses)) return;
    }
  }
  relax_each(e, {{all_limits(e.problem), {}, 0}}, guesses);
}

bool is_enough(const Problem& easier, const std::string& what, const Guess& near, bool near_first, Search& search) {
  Problem quick = fastest_of(easier);
  if (any_timed(easier)) {
    quick.via = easier.via;
    quick.duration = easier.duration;
  }
  std::vector<Guess> guesses = search.guesses(quick);
  guesses.insert(near_first ? guesses.begin() : guesses.end(), near);
  const auto found = search.plan(quick, what, guesses);
  return found &&
         (any_timed(easier) || (1 + search.settings().duration_margin) * found->duration() <= easier.duration.max);
}

}  // namespace fjr
