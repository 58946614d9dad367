#include "planner/search/follow.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "planner/ocp/objective.h"
#include "planner/problem/task/task.h"
#include "planner/search/acceleration_penalty.h"

namespace fjr {
namespace {

// Returns whether the candidate that was found last is worth refining, compared with those before it.
bool last_promises(const Findings& found, const FollowSettings& settings) {
  std::vector<CoarseSolution> best_first;
  for (const CoarseMotion& c : found.candidates) best_first.push_back(c.coarse);
  std::stable_sort(best_first.begin(), best_first.end(),
                   [](const CoarseSolution& a, const CoarseSolution& b) { return a.objective < b.objective; });
  const Weights& weights = found.asked.weights;
  const std::vector<bool> worth = worth_refining(best_first, refining(weights, 0, settings).within,
                                                 [&](int starts) { return refining(weights, starts, settings).most; });
  const int last = found.candidates.back().coarse.start;
  for (std::size_t i = 0; i < worth.size(); ++i) {
    if (best_first[i].start == last) return worth[i];
  }
  return true;
}

// Returns whether a fastest motion takes so much longer than allowed that it need not be refined. Motions of many
// seconds are refined to thousands of intervals, and their duration is known to a per cent before.
bool far_too_long(const Continuation& c, const Problem& asked, const FollowSettings& settings) {
  const double duration = c.duration();
  return only_time(asked.weights) && duration > settings.long_motion &&
         duration > settings.far_too_long * asked.duration.max;
}

// Solves a motion again with a penalty on accelerations, from this guess. Returns none if that fails.
std::optional<Continuation> solved_with_penalty(const Continuation& coarse,
                                                const std::shared_ptr<const Problem>& problem, const Guess& guess,
                                                int iterations, Session& session) {
  Continuation solved(problem, session, coarse.label() + ", with acceleration penalty");
  solved.start = coarse.start;
  if (solved.begin(guess, iterations) != StartOutcome::kNew) return std::nullopt;
  return solved;
}

// Result of a start on a coarse mesh.
struct Begun {
  Continuation motion;
  StartOutcome outcome;
};

// Returns the problem with q as its goal, where the request leaves joints of the goal free.
std::shared_ptr<const Problem> ending_at(const Problem& problem, const Joints<double>& q) {
  Problem given = problem;
  given.goal.q = q;
  given.goal.free = {false, false};
  if (given.goal.at_rest) given.goal.theta = rest_at(given.robot, q).theta;
  return std::make_shared<const Problem>(std::move(given));
}

// The problem that a guess is solved for at first, where that is not the start's own one.
struct FirstProblem {
  std::shared_ptr<const Problem> problem;
  std::string what;
};

std::optional<FirstProblem> first_problem(const Start& start) {
  if (start.guess.first_end) return FirstProblem{ending_at(*start.alternative, *start.guess.first_end), "end given"};
  if (start.guess.first_longest.empty()) return std::nullopt;
  Problem bounded = *start.alternative;
  bounded.variation.longest = start.guess.first_longest;
  return FirstProblem{std::make_shared<const Problem>(std::move(bounded)), "segments bounded"};
}

// Returns the solution of the guess's first problem, if there is one.
std::optional<Guess> first_motion(const Start& start, int iterations, Session& session) {
  const std::optional<FirstProblem> first = first_problem(start);
  if (!first) return std::nullopt;
  Continuation c(first->problem, session, fmt::format("{}, {}", start.label, first->what),
                 {.by_interior_point = start.by_interior_point});
  if (c.begin(start.guess, iterations) != StartOutcome::kNew) return std::nullopt;
  return guess_of(c.solution());
}

// Begins a start; if its guess asks for that, from the solution of a first problem. With longer segments allowed, such
// a solution mostly remains one, and a small barrier keeps it.
Begun begin_start(const Start& start, int iterations, const std::vector<double>& known, Session& session) {
  const std::optional<Guess> first = first_motion(start, iterations, session);
  const auto begin = [&](std::optional<double> barrier) {
    Continuation c(start.alternative, session, start.label,
                   {.by_interior_point = start.by_interior_point, .barrier = barrier});
    const StartOutcome outcome = c.begin(first.value_or(start.guess), iterations, known);
    return Begun{std::move(c), outcome};
  };
  if (first && !start.guess.first_longest.empty()) {
    Begun begun = begin(session.settings().follow.barrier_after_bounds);
    if (begun.outcome != StartOutcome::kNoSolution || session.interrupted()) return begun;
  }
  return begin(std::nullopt);
}

// Refines a fastest motion of many seconds, whose springs have time to oscillate, with penalties on accelerations: the
// largest first, until one is certified. Where the motion oscillates so much already that none is solved from it, a
// smooth one is the guess, and if nothing comes of that the motion is refined as it is.
void refine_with_penalties(const Continuation& coarse, Findings& found, Session& session) {
  const Timed timed(session, "finish");
  const SearchSettings& s = session.settings();
  bool all_solved = true;
  for (const auto& penalised : fastest_with_acceleration_penalties(*coarse.problem(), s.acceleration_penalty)) {
    if (session.interrupted()) return;
    auto c = solved_with_penalty(coarse, penalised, guess_of(coarse.solution()), found.start_iterations, session);
    all_solved = all_solved && c.has_value();
    if (!c && count_of_rows(penalised->task) == 0 && !session.interrupted()) {
      const Guess smooth = minimum_jerk_guess(*penalised, coarse.duration());
      c = solved_with_penalty(coarse, penalised, smooth, s.follow.iterations, session);
    }
    if (!c || c->refine() == Completion::kStopped) continue;
    if (found.keep(*c, publish(*c, found.asked, session))) return;
  }
  if (all_solved || session.interrupted()) return;
  Continuation plain = coarse;
  if (plain.refine() == Completion::kFinished) found.keep(plain, publish(plain, found.asked, session));
}

// Refines motions in a race. While nothing is certified, those that were dropped in the race are refined too.
void refine_all(std::vector<Continuation> coarse, Findings& found, Session& session) {
  if (coarse.empty()) return;  // entering the phase of refining would release its part of the work budget for nothing
  session.enter(Phase::kRefining);
  const auto is_long_and_fastest = [&](const Continuation& c) {
    return only_time(c.problem()->weights) && c.duration() >= session.settings().follow.long_motion;
  };
  std::vector<Continuation> motions;
  for (Continuation& c : coarse) {
    ++found.refined;
    if (is_long_and_fastest(c)) {
      refine_with_penalties(c, found, session);
    } else {
      motions.push_back(std::move(c));
    }
  }
  Raced raced = [&] {
    const Timed timed(session, "finish");
    return race(std::move(motions), found.reached, session);
  }();
  publish_best(std::move(raced.arrived), found, session);
  for (Continuation& motion : raced.dropped) {
    if (found.certified() || session.interrupted()) break;
    if (motion.refine() == Completion::kFinished) publish_best({std::move(motion)}, found, session);
  }
}

// Notes a motion that was found on a coarse mesh. Returns whether it is worth refining: while nothing is certified,
// every motion is, unless it is far too long.
bool note(const Continuation& c, Findings& found, Session& session) {
  const Collocated& coarse = c.solution();
  found.candidates.push_back({c.problem(), {coarse.report.objective, c.start}, coarse.motion, coarse.durations});
  if ((found.certified() && !last_promises(found, session.settings().follow)) || session.interrupted()) return false;
  if (!far_too_long(c, found.asked, session.settings().follow)) return true;
  found.note_fastest(c, false);
  return false;
}

TriedStart note_outcome(Begun& begun, const Guess& guess, Findings& found, const SearchSettings& settings) {
  Continuation& c = begun.motion;
  c.start = ++found.starts;
  if (begun.outcome == StartOutcome::kNoSolution) {
    if (c.status() == SolveStatus::kInfeasible) found.a_start_was_infeasible = true;
    if (!c.obstacle().empty()) found.obstacle = "; in the last attempt " + c.obstacle();
    return c.status() == SolveStatus::kIterationLimit ? TriedStart::kOutOfIterations : TriedStart::kNowhere;
  }
  // Starts of one wave do not see each other's results: two of them may have found the same minimum.
  const SolverStage& first = c.stages().front();
  const double objective = first.objective;
  if (any_same(found.minima, objective, settings.continuation.first.same_minimum)) begun.outcome = StartOutcome::kKnown;
  if (begun.outcome == StartOutcome::kKnown) return TriedStart::kSomewhere;
  // Later starts that take many more iterations than this one are given up early. The limit counts iterations and not
  // time, so that results are reproducible. A start with a first problem does not tell how hard others are.
  if (!guess.first_end && guess.first_longest.empty()) {
    const FollowSettings& s = settings.follow;
    found.start_iterations =
        std::min(found.start_iterations, std::max(s.least_iterations, s.slower * first.iterations));
  }
  found.minima.push_back(objective);
  return TriedStart::kSomewhere;
}

}  // namespace

Refining refining(const Weights& weights, int starts, const FollowSettings& settings) {
  const int more = std::max(0, starts - starts_worth_trying(weights));
  if (!sees_friction(weights)) return {settings.within, settings.most + more};
  return {settings.within_with_friction, settings.most_with_friction + more};
}

void follow(Continuation c, Findings& found, Session& session) {
  if (note(c, found, session)) refine_all({std::move(c)}, found, session);
}

void publish_best(std::vector<Continuation> motions, Findings& found, Session& session) {
  const Timed timed(session, "finish");
  std::vector<std::pair<double, Continuation*>> best_first;
  for (Continuation& motion : motions) {
    best_first.emplace_back(published_objective(found.asked, motion.solution()), &motion);
  }
  std::stable_sort(best_first.begin(), best_first.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [objective, motion] : best_first) {
    if (found.certified() && objective >= found.best->objective) return;
    PublishResult published = publish(*motion, found.asked, session);
    found.keep(*motion, std::move(published));
  }
}

void refine_waiting(Findings& found, Session& session) { refine_all(std::exchange(found.waiting, {}), found, session); }

void follow_damped(const std::vector<CoarseMotion>& coarse, Findings& found, Session& session) {
  const auto best = std::min_element(coarse.begin(), coarse.end(), [](const CoarseMotion& a, const CoarseMotion& b) {
    return a.coarse.objective < b.coarse.objective;
  });
  if (best == coarse.end()) return;
  const double duration = best->motion.duration();
  const auto problem =
      with_damping(*best->problem, best->coarse.objective, duration, session.settings().acceleration_penalty);
  if (!problem) return;
  session.enter(Phase::kDamping);
  const Timed timed(session, "finish");
  ++session.fallbacks().calmed;
  ContinuationStrategy strategy = usual_strategy(*problem);
  strategy.steps = {{strategy.steps.front().friction_width, strategy.steps.back().regularisation}};
  Continuation c(problem, session, "with acceleration penalty", {.strategy = strategy});
  c.start = best->coarse.start;
  const Guess guess = count_of_rows(problem->task) == 0 ? minimum_jerk_guess(*problem, duration)
                                                        : guess_of(best->motion, best->durations);
  if (c.begin(guess, found.start_iterations) != StartOutcome::kNew || c.refine() == Completion::kStopped) return;
  PublishResult published = publish(c, found.asked, session);
  if (published.certified()) found.keep(c, std::move(published));
}

std::vector<TriedStart> try_starts_of_many(const std::vector<Start>& starts, Findings& found, Session& session) {
  std::vector<std::optional<Begun>> begun(starts.size());
  const auto begin = [&, iterations = found.start_iterations](std::size_t i, Session& own) {
    begun[i] = begin_start(starts[i], iterations, found.minima, own);
  };
  const std::vector<PieceOfWork> pieces =
      found.waiting.empty() ? session.do_all(starts.size(), begin)
                            : session.do_beside([&] { refine_waiting(found, session); }, starts.size(), begin);
  std::vector<TriedStart> tried(starts.size(), TriedStart::kNowhere);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (pieces[i] == PieceOfWork::kIgnored) continue;
    begun[i]->motion.go_on_in(session);
    tried[i] = note_outcome(*begun[i], starts[i].guess, found, session.settings());
    const bool is_new = begun[i]->outcome == StartOutcome::kNew;
    if (is_new && note(begun[i]->motion, found, session)) found.waiting.push_back(std::move(begun[i]->motion));
  }
  if (!found.waiting.empty()) session.enter(Phase::kRefining);
  return tried;
}

std::vector<TriedStart> try_starts(const std::vector<Start>& starts, Findings& found, Session& session) {
  refine_waiting(found, session);
  std::vector<TriedStart> tried = try_starts_of_many(starts, found, session);
  refine_waiting(found, session);
  return tried;
}

}  // namespace fjr
