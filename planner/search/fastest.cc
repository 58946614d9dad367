#include "planner/search/fastest.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "planner/search/follow.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

// Returns the first fastest motion that takes no more than `allowed` [s], or else the shortest one. A motion that takes
// longer is certified if possible, because its duration is reported to the user.
std::optional<Fastest> find_fastest(const std::shared_ptr<const Problem>& alternative, double allowed, Findings& found,
                                    Session& session) {
  const auto fastest = std::make_shared<const Problem>(fastest_of(*alternative));
  std::optional<Fastest> shortest;
  std::vector<double> known;  // minima
  for (const Guess& guess : first_guesses(*fastest, session.settings().starts)) {
    if (session.interrupted() || (shortest && shortest->duration() <= allowed)) break;
    Continuation c(fastest, session, "fastest");
    if (c.begin(guess, found.patience, known) != StartOutcome::kNew) continue;
    known.push_back(c.stages().front().objective);
    if (c.refine() == Completion::kStopped) continue;
    bool certified = false;
    if (c.duration() > allowed) {
      const PublishResult published = publish(c, found.asked, session);
      certified = published.certified();
      if (!published.failure.empty()) found.failure = published.failure;
    }
    if (!shortest || c.duration() < shortest->duration()) shortest = Fastest{std::move(c), certified, alternative};
  }
  return shortest;
}

// Returns how the fastest motion to the goal gets to via point i, with the times of those before it kept. Usual guesses
// rest at the points, and what they lead to turns back where a point is to be passed soon after another: 0.374 s were
// told for a point that can be passed at 0.324 s.
std::optional<Guess> on_the_way_to_goal(const Problem& problem, std::size_t i, const std::string& what,
                                        Search& search) {
  Problem fastest = fastest_of(problem);
  for (std::size_t k = 0; k < i; ++k) {
    fastest.via[k].time = problem.via[k].time;
    fastest.duration.min = problem.via[k].time.value_or(fastest.duration.min) + kShortestDuration;
  }
  const auto found = search.sketch(fastest, what, search.guesses(fastest));
  if (!found) return std::nullopt;
  return first_segments_of(guess_of(*found), i + 1);
}

}  // namespace

Problem fastest_of(Problem problem) {
  problem.weights = Weights{};
  problem.weights.time = 1;
  problem.duration = {kShortestDuration, kLongestDuration};
  for (Via& via : problem.via) via.time.reset();
  problem.variation.pause.reset();
  return problem;
}

Problem fastest_to_via(Problem problem, std::size_t i) {
  const Via via = problem.via[i];
  problem.goal = Goal{};
  problem.goal.q = via.q;
  problem.goal.dq = via.dq.value_or(Joints<double>{});
  problem.goal.dq_free = !via.dq;
  problem.goal.at_rest = false;
  problem.other_goals.clear();
  problem.release.reset();
  problem.via.resize(i);
  const double before = i > 0 ? problem.via.back().time.value_or(0) : 0;
  problem.duration = {before + kShortestDuration, kLongestDuration};
  problem.weights = {.time = 1};
  return problem;
}

std::optional<Continuation> sketch_to_via(const Problem& problem, std::size_t i, Search& search) {
  const std::string what = fmt::format("via[{}].time", i);
  const Problem hurry = fastest_to_via(problem, i);
  std::vector<Guess> guesses = search.guesses(hurry);
  if (i > 0) {
    if (auto onward = on_the_way_to_goal(problem, i, what, search)) guesses.push_back(*std::move(onward));
  }
  return search.least_sketch(hurry, what, guesses);
}

void try_from_fastest(const std::shared_ptr<const Problem>& alternative, Findings& found, Session& session) {
  const double allowed = alternative->duration.max;
  if (!found.candidates.empty() || session.interrupted()) return;
  const bool was_tried = only_time(alternative->weights) && alternative->duration.min <= kShortestDuration;
  if (was_tried) return;
  ++session.fallbacks().from_fastest;
  const std::optional<Fastest> shortest = find_fastest(alternative, allowed, found, session);
  if (!shortest) return;
  if (!found.fastest || shortest->duration() < found.fastest->duration()) found.fastest = shortest;
  if (shortest->duration() > allowed || any_timed(*alternative)) return;
  const double duration = std::clamp(shortest->duration(), alternative->duration.min, allowed);
  const Collocated& solution = shortest->motion.solution();
  try_starts({{alternative, guess_from(solution.motion, solution.durations, duration), "from the fastest"}}, found,
             session);
  if (found.candidates.empty() && !session.interrupted()) adopt_fastest(found, session);
}

bool has_little_spare_time(const Findings& found) {
  constexpr double kHardlyMore = 1.05;  // times the shortest duration
  return found.fastest && !any_timed(found.asked) && !only_time(found.asked.weights) &&
         found.asked.duration.max < kHardlyMore * found.fastest->duration();
}

void adopt_fastest(Findings& found, Session& session) {
  Fastest& fastest = *found.fastest;
  Continuation c(fastest.alternative, session, "from the fastest, exact");
  const Completion refined = fastest.motion.refine();
  const Duration& allowed = found.asked.duration;
  if (refined == Completion::kStopped || fastest.duration() > allowed.max) return;
  const double duration = std::clamp(fastest.duration(), allowed.min, allowed.max);
  if (c.adopt(fastest.motion.solution(), duration)) follow(std::move(c), found, session);
}

}  // namespace fjr
