#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/relaxable.h"
#include "planner/search/explain/reasons.h"
#include "planner/search/explain/relaxing.h"
#include "planner/search/explain/via_times.h"
#include "planner/search/fastest.h"
#include "planner/search/slack.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

// Drops limits that would have to grow by more than a slack may be, or by more than their size where a request may not
// ask for that. To save the missing time a limit has to grow by at least that time divided by the limit's weight,
// because as a rule the more it has grown the less further growth saves. All of 19 limits that were found to be enough
// had grown by more, and of 39 that this drops none was enough. Discs and regions are kept, because beyond some size
// they open another path.
void drop_weak(std::vector<Candidate>& single, const Explanation& e) {
  const double missing = e.shortest() - e.problem.duration.max;  // [s]
  std::erase_if(single, [&](const Candidate& c) {
    const double least_change = missing / c.weight;  // as a fraction of the limit's size
    const double allowed = c.what.allowed / c.what.size();
    const double most = std::clamp(allowed, e.settings().large_change, e.slack_settings().most);
    return c.what.kind == RelaxableKind::kLimit && least_change > most;
  });
}

// Alone, each limit has to grow by no less than all of them together. Where that is more than a quarter, limits that
// would then exceed the robot's are not tried: a request may not ask for them, and mostly no motion is found. Returns
// nothing if no motion was found even with all of them larger, because one alone is hardly enough then.
std::optional<std::vector<Candidate>> worth_trying_alone(Explanation& e, std::vector<Candidate> single,
                                                         const std::vector<Guess>& guesses) {
  e.anything_tried = true;
  const Problem everything = with_slack(e.problem, all_limits(e.problem), e.slack_settings());
  const auto least = e.search.sketch(everything, "all_limits", guesses, e.settings().solves.iterations_of_slack);
  if (!least) return std::nullopt;
  const double slack = least->solution().slack;
  if (slack > e.settings().slack_beyond_single_limits) keep_within_robot(single, slack);
  drop_weak(single, e);
  return single;
}

// Reports how long the shortest motion takes if the via points are passed at the requested times, or which of these
// would have to change as well; the shortest motion itself ignores them. Returns whether two times that are enough
// together are reported.
bool explain_times_as_well(Explanation& e) {
  Problem timed = fastest_of(e.problem);
  timed.via = e.problem.via;
  for (const Via& via : timed.via) timed.duration.min = via.time.value_or(timed.duration.min) + kShortestDuration;
  if (const auto kept = e.search.solve(timed, "duration", e.search.guesses(timed))) {
    const double needed = e.rounded_up(kept->solution().motion.duration());
    e.result.sentence += fmt::format(", and {:.4f} s with the via points at their times", needed);
    e.result.relaxations.push_back(
        relaxation_of_time(RelaxableKind::kDuration, "duration", e.problem.duration.max, needed));
    return false;
  }
  for (std::size_t i = 0; i < e.problem.via.size() && !e.search.over(); ++i) {
    const auto asked = e.problem.via[i].time;
    const auto earliest = asked ? earliest_at(e.problem, i, e.search) : std::nullopt;
    if (!earliest || *earliest <= *asked) continue;
    e.result.sentence +=
        fmt::format("; via[{}] is to be passed at {:.6g} s, and within the limits it cannot be passed before {:.4f} s",
                    i, *asked, e.rounded_up(*earliest));
    return tell_both(e, i, *earliest, *e.known.fastest);
  }
  return false;
}

}  // namespace

void explain_duration(Explanation& e) {
  const double allowed = e.problem.duration.max;
  const double needed = e.rounded_up((e.known.certified ? 1 : 1 + e.settings().margin) * e.shortest());
  e.result.shortest_duration = needed;
  const std::string where =
      allowed == kLongestByDefault ? fmt::format(" (duration.max may be up to {:g} s)", kLongestDuration) : "";
  e.result.sentence = fmt::format(
      "duration: at most {:.6g} s is allowed{}; the shortest motion found within the limits takes {}{:.4f} s", allowed,
      where, e.known.certified ? "" : "about ", needed);
  if (!e.known.certified) e.result.sentence += " (an estimate: this motion is not certified)";
  const double rows = needed / e.problem.longest_sample_period;
  if (rows > static_cast<double>(kMaxRows)) {
    e.result.sentence +=
        fmt::format(" (with a sample_period of {:.4f} s or more)",
                    std::ceil(1e4 * needed / static_cast<double>(kMaxRows - e.settings().more_rows)) / 1e4);
  }
  e.result.limit = "duration";
  e.result.time = allowed;
  if (!any_timed(e.problem)) {
    // With hardly more time than the fastest motion takes, other objectives are seldom found.
    const double enough = only_time(e.problem.weights) ? needed : e.rounded_up((1 + e.settings().spare_time) * needed);
    e.result.relaxations.push_back(relaxation_of_time(RelaxableKind::kDuration, "duration", allowed, enough));
    e.result.relaxations.back().rough = !e.known.certified;
  } else if (explain_times_as_well(e)) {
    return;  // limits that keep both times as they are would have to be far larger, and take long to find
  }
  const Collocated& fastest = e.known.fastest->solution();
  const std::vector<Guess> hurried{guess_from(fastest.motion, fastest.durations, allowed)};
  const std::vector<Candidate> active = active_in(*e.known.fastest, e.settings());
  const auto single = worth_trying_alone(e, active, hurried);
  if (single && !relax_each(e, *single, hurried)) relax_together(e, active, hurried);
}

}  // namespace fjr
