#include "planner/search/starts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "planner/problem/task/task.h"
#include "planner/problem/tip_path.h"
#include "planner/search/clear_guesses.h"
#include "planner/search/detours.h"

namespace fjr {
namespace {

// Returns sets of one path per segment: round obstacles, on both sides if possible; along the tip's line or arc, and if
// that is wide through its region too. Returns none if nothing asks for it.
std::vector<std::vector<Path>> task_paths(const Problem& problem, std::size_t most_paths) {
  const Task& task = problem.task;
  const std::optional<TipPath> along_tip_path = tip_path(task);
  if (along_tip_path && along_tip_path->tolerance < kWideTipPath) return {paths_along_tip_path(problem)};
  if (task.path || (!keeps_clear(task) && !task.box && !along_tip_path)) return {};
  const std::vector<Joints<double>> points = waypoints(problem);
  std::vector<std::vector<Path>> all(1);
  const DetourFinder finder(problem);
  std::vector<std::vector<Path>> others;  // of one segment, with its index
  for (std::size_t s = 0; s + 1 < points.size(); ++s) {
    Detours detours = finder.find(s, points[s], points[s + 1], most_paths);
    if (detours.paths.empty()) detours.paths.push_back(detours.widest);
    all.front().push_back(detours.paths.front());
    others.emplace_back(detours.paths.begin() + 1, detours.paths.end());
  }
  for (std::size_t s = 0; s < others.size(); ++s) {  // one segment goes the other way round at a time
    for (const Path& other : others[s]) {
      all.push_back(all.front());
      all.back()[s] = other;
    }
  }
  if (along_tip_path) all.push_back(paths_along_tip_path(problem));
  return all;
}

// Returns the end [rad] that takes the least torque to hold, as a fraction of the torque limits. Free joints are varied
// and the others kept. Among ends that take the same, such as hanging and upright, the nearer one is chosen.
Joints<double> easiest_end(const Problem& problem, double by_distance) {
  constexpr int kAngles = 200;
  const auto held = [&](const Joints<double>& q) {
    const Joints<double> gravity = gravity_torque(problem.robot, q);
    double sum = 0;
    for (std::size_t j = 0; j < kJoints; ++j) {
      sum += std::pow(gravity[j] / problem.limits.torque[j], 2) + by_distance * std::abs(q[j] - problem.goal.q[j]);
    }
    return sum;
  };
  Joints<double> easiest = problem.goal.q;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!problem.goal.free[j]) continue;
    for (int i = 0; i <= kAngles; ++i) {
      Joints<double> q = easiest;
      q[j] = std::lerp(problem.limits.lowest(j), problem.limits.highest(j), i / double{kAngles});
      if (held(q) < held(easiest)) easiest = q;
    }
  }
  return easiest;
}

// Returns ends [rad] to try for free joints: the one that is easiest to hold, half way there, and beyond the last via
// point.
std::vector<Joints<double>> other_ends(const Problem& problem, const StartSettings& settings) {
  const Joints<double> expected = problem.goal.q, easiest = easiest_end(problem, settings.end_by_distance);
  std::vector<Joints<double>> ends{easiest, expected};
  for (std::size_t j = 0; j < kJoints; ++j) ends[1][j] = std::midpoint(expected[j], easiest[j]);
  if (problem.via.empty()) return ends;
  const std::size_t count = problem.via.size();
  const Joints<double>&last = problem.via.back().q, &before = count > 1 ? problem.via[count - 2].q : problem.start.q;
  ends.push_back(expected);
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!problem.goal.free[j]) continue;
    ends[2][j] = std::clamp(2 * last[j] - before[j], problem.limits.lowest(j), problem.limits.highest(j));
  }
  return ends;
}

// Returns whether the motion may end there: the task is kept, and the torque limits hold it if it is to rest.
bool may_end_at(const Problem& problem, const Joints<double>& q) {
  const auto posture = Posture<double>::of(problem.robot, q);
  const std::vector<TaskRow> rows = task_rows(problem.robot, problem.task, problem.via.size());
  if (std::any_of(rows.begin(), rows.end(),
                  [&](const TaskRow& row) { return row.clearance(row.value(problem.robot, posture)) < 0; })) {
    return false;
  }
  const Joints<double> gravity = gravity_torque(problem.robot, q);
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (problem.goal.at_rest && std::abs(gravity[j]) > problem.limits.torque[j]) return false;
  }
  return true;
}

// Returns guesses with other ends of free joints, because minima differ by these: of 99 motions with a free end, seven
// came to 2 % to four times more from guesses that end by the start. If the end is free from the beginning, the
// optimiser moves it back to the start before the guess has become a motion of the arm. So the first solve keeps the
// end.
std::vector<Guess> guesses_of_other_ends(const Problem& problem, const StartSettings& settings) {
  if (!problem.goal.any_free() || only_time(problem.weights)) return {};
  std::vector<Guess> guesses;
  std::vector<Joints<double>> tried{problem.goal.q};
  Problem other = problem;
  for (const Joints<double>& end : other_ends(problem, settings)) {
    const bool known = std::any_of(tried.begin(), tried.end(), [&](const Joints<double>& before) {
      return std::abs(end[0] - before[0]) + std::abs(end[1] - before[1]) < settings.another_end;
    });
    if (known || !may_end_at(problem, end)) continue;
    tried.push_back(end);
    other.goal.q = end;
    guesses.push_back(straight_guess(other, duration_guess(other)));
    guesses.back().first_end = end;
  }
  return guesses;
}

// Returns whether a guess is wanted that passes the via points without stopping. From guesses that stop at each of them
// an arm that moves already turns back there (8 of 12 motions with two via points, or one with a velocity, took up
// to 2.7 times as long). So does a fastest motion that is to have a velocity at one (of 143 random ones, 12 took 22 to
// 74 % longer and 7 were refused) or at the goal. Other objectives have more starts anyway.
bool passes_vias_moving(const Problem& problem) {
  if (problem.via.empty()) return false;
  if (!problem.start_at_rest) return true;
  const auto moves = [](const Joints<double>& dq) { return dq[0] * dq[0] + dq[1] * dq[1] > 0; };
  const bool any_velocity =
      moves(problem.goal.dq) ||
      std::any_of(problem.via.begin(), problem.via.end(), [&](const Via& via) { return via.dq && moves(*via.dq); });
  return any_velocity && only_time(problem.weights);
}
constexpr int kPlain = 3;  // the passing guess, minimum jerk and straight

// Returns the guess that passes via points. A fastest motion's segments are bounded at first: a joint that moves either
// gets to the next point at once or has to go back and come again, and an optimiser that has begun to lengthen a
// segment for the latter seldom returns.
Guess passing_start(const Problem& problem, const StartSettings& settings) {
  Guess guess = passing_guess(problem);
  if (!only_time(problem.weights) || problem.duration.fixed()) return guess;
  for (const double time : guess.durations) guess.first_longest.push_back(settings.longest_passing * time);
  return guess;
}

std::vector<Guess> plain_guesses(const Problem& problem, double duration) {
  // From minimum jerk the fastest motion takes nearly half the iterations (68 in place of 118 in the median of 26
  // motions), and finds no worse minima; for effort the plain guess is often better.
  std::vector<Guess> guesses{straight_guess(problem, duration), minimum_jerk_guess(problem, duration)};
  if (only_time(problem.weights)) std::swap(guesses[0], guesses[1]);
  return guesses;
}

// Minima of throws differ by the directions in which the joints move at the release. Returns a guess for each of them,
// which first moves back where the way is too short for the speed; none if the request prescribes the velocity.
std::vector<Guess> throwing_guesses(const Problem& problem, double fraction_of_speed) {
  if (!has_reward(problem.weights)) return {};
  const bool prescribed = problem.release ? problem.via[*problem.release].dq.has_value() : !problem.goal.dq_free;
  if (prescribed) return {};
  std::vector<Guess> guesses;
  for (unsigned directions = 0; directions < 1U << kJoints; ++directions) {
    Joints<double> velocity;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double sign = (directions >> j & 1U) != 0 ? -1 : 1;
      velocity[j] = sign * fraction_of_speed * problem.limits.motor_velocity[j];
    }
    Problem thrown = problem;
    if (problem.release) {
      thrown.via[*problem.release].dq = velocity;
    } else {
      thrown.goal.dq = velocity;
      thrown.goal.dq_free = false;
    }
    guesses.push_back(passing_guess(thrown));
    guesses.back().name = "throwing";
  }
  return guesses;
}

// With time to spare a motor rests, and minima differ by when it does.
constexpr std::size_t kWaiting = 2;
std::vector<Guess> waiting_guesses(const Guess& guess, const StartSettings& settings) {
  return {waiting_guess(guess, settings.waiting, 0), waiting_guess(guess, 0, settings.waiting)};
}

// Returns guesses in which joints rest: first the kWaiting ones that wait at an end, then others.
std::vector<Guess> resting_guesses(const Problem& problem, double duration, const StartSettings& settings) {
  std::vector<Guess> guesses = waiting_guesses(minimum_jerk_guess(problem, duration), settings);
  if (auto hanging = hanging_guess(problem, duration)) guesses.push_back(std::move(*hanging));
  for (std::size_t j = 0; j < kJoints; ++j) guesses.push_back(staggered_guess(problem, duration, j));
  return guesses;
}

// Returns whether obstacles leave a choice of the path. Along a given path there is nothing to choose.
bool may_choose_path(const Task& task) { return keeps_clear(task) && !task.path && !tip_path(task); }

// Minima round obstacles are many where friction weighs, and starts that keep clear of the obstacles find them.
bool wants_clear_guesses(const Problem& problem) {
  return sees_friction(problem.weights) && may_choose_path(problem.task);
}

std::vector<Guess> clear_ones_of(std::vector<Guess> guesses, const Problem& problem) {
  std::erase_if(guesses, [&](const Guess& guess) { return !keeps_clear(problem, guess); });
  return guesses;
}

enum class FirstSolve { kByIpopt, kByInteriorPoint };

void add(const std::vector<Guess>& guesses, FirstSolve solve, Starts& starts) {
  for (const Guess& guess : guesses) {
    starts.guesses.push_back({.guess = guess, .by_interior_point = solve == FirstSolve::kByInteriorPoint});
  }
}

// Adds guesses that keep clear of obstacles. smooth: those along the paths round them.
void add_clear_guesses(const Problem& problem, double duration, const std::vector<Path>& path,
                       const std::vector<Guess>& smooth, const StartSettings& settings, Starts& starts) {
  constexpr FirstSolve kSolve = FirstSolve::kByInteriorPoint;
  add(smooth, kSolve, starts);
  add(clear_guesses_by_postures(problem, duration, path), kSolve, starts);
  starts.enough = starts.guesses.size() + settings.further;
  for (const Guess& guess : smooth) add(waiting_guesses(guess, settings), kSolve, starts);
  add(clear_ones_of(plain_guesses(problem, duration), problem), kSolve, starts);
  add(clear_ones_of(resting_guesses(problem, duration, settings), problem), kSolve, starts);
}

// Adds the guesses of motions that obstacles are no matter of, or only time. other_ends: those of free joints.
void add_usual_guesses(const Problem& problem, double duration, const std::vector<Guess>& other_ends,
                       FirstSolve later_solves, const StartSettings& settings, Starts& starts) {
  add(plain_guesses(problem, duration), FirstSolve::kByIpopt, starts);
  add(throwing_guesses(problem, settings.throwing_speed), FirstSolve::kByIpopt, starts);
  const bool rests = sees_friction(problem.weights);
  starts.enough = starts.guesses.size() + (rests ? kWaiting : 0) + settings.further + other_ends.size();
  if (rests) add(resting_guesses(problem, duration, settings), later_solves, starts);
  add(other_ends, later_solves, starts);
}

// Returns the starts of the motion without its pause, with the pause put in.
Starts starts_with_pause(const Problem& problem, int count, const StartSettings& settings) {
  const Pause& pause = *problem.variation.pause;
  Problem moving = problem;
  moving.variation.pause.reset();
  moving.duration.max -= pause.duration();
  moving.duration.min = moving.duration.max;
  Starts starts = starts_of(moving, count, settings);
  for (StartGuess& start : starts.guesses) {
    start.guess = paused_guess(std::move(start.guess), pause.begin, pause.duration());
    if (!start.along_path_again) continue;
    start.along_path_again = paused_guess(*std::move(start.along_path_again), pause.begin, pause.duration());
  }
  return starts;
}

}  // namespace

int starts_to_try(const Problem& problem, int asked, const StartSettings& settings) {
  if (asked > 0) return asked;
  const int more = wants_clear_guesses(problem) ? settings.more_among_obstacles : 0;
  const int usual = std::max(starts_worth_trying(problem.weights) + more, passes_vias_moving(problem) ? kPlain : 1);
  switch (problem.search) {
    case Thoroughness::kQuick:
      return 1;
    case Thoroughness::kDefault:
      return usual;
    case Thoroughness::kThorough:
      return settings.thorough * usual;
  }
  return usual;
}

std::vector<Guess> guesses_of(const Starts& starts) {
  std::vector<Guess> guesses;
  for (const StartGuess& start : starts.guesses) guesses.push_back(start.guess);
  return guesses;
}

std::size_t count_along_paths(const Starts& starts) {
  const auto has_none = [](const StartGuess& start) { return !start.along_path_again; };
  const auto first = std::find_if(starts.guesses.begin(), starts.guesses.end(), has_none);
  return static_cast<std::size_t>(first - starts.guesses.begin());
}

Starts starts_of(const Problem& problem, int count, const StartSettings& settings) {
  if (problem.variation.pause) return starts_with_pause(problem, count, settings);
  const double duration = duration_guess(problem);
  const std::vector<std::vector<Path>> paths = task_paths(problem, settings.most_paths);
  const bool keeps_clear = wants_clear_guesses(problem);
  std::vector<Guess> smooth;  // along the paths
  if (may_choose_path(problem.task)) {
    for (const std::vector<Path>& p : paths) smooth.push_back(smooth_path_guess(problem, duration, p));
  }
  Starts starts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    starts.guesses.push_back({.guess = path_guess(problem, duration, paths[i])});
    if (!keeps_clear && !smooth.empty()) starts.guesses.back().along_path_again = smooth[i];
  }
  starts.always = std::max(starts.guesses.size(), static_cast<std::size_t>(count));
  if (passes_vias_moving(problem)) add({passing_start(problem, settings)}, FirstSolve::kByIpopt, starts);
  const std::vector<Guess> other_ends = guesses_of_other_ends(problem, settings);
  const bool own = keeps_clear || (sees_friction(problem.weights) && count_of_rows(problem.task) == 0);
  const FirstSolve later_solves = own ? FirstSolve::kByInteriorPoint : FirstSolve::kByIpopt;
  if (keeps_clear) {
    add(other_ends, FirstSolve::kByIpopt, starts);
    add_clear_guesses(problem, duration, paths.front(), smooth, settings, starts);
  } else {
    add_usual_guesses(problem, duration, other_ends, later_solves, settings, starts);
  }
  if (count > 1) starts.always += other_ends.size();  // if one start was asked for, only one is tried
  const std::size_t made_for_request = starts.guesses.size(), count_of_all = std::max(starts.always, starts.enough);
  const std::size_t first_near = keeps_clear ? settings.near_the_best_among_obstacles : 0;
  for (std::uint64_t i = 2; starts.guesses.size() < count_of_all; ++i) {
    const std::uint64_t seed = problem.seed * 1000 + i;
    const std::size_t displaced = starts.guesses.size() - made_for_request;
    Guess guess = keeps_clear ? displaced_clear_guess(problem, smooth[i % smooth.size()], settings.far_away, seed)
                              : displaced_guess(problem, duration, settings.far_away, seed);
    add({std::move(guess)}, later_solves, starts);
    starts.guesses.back().near_the_best = displaced < first_near || displaced % 2 == 1;
  }
  return starts;
}

std::vector<Guess> first_guesses(const Problem& problem, const StartSettings& settings) {
  return guesses_of(starts_of(problem, settings.for_neighbour, settings));
}

}  // namespace fjr
