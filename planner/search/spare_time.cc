#include "planner/search/spare_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "model/friction.h"
#include "planner/problem/objective_terms.h"
#include "planner/search/fallbacks.h"
#include "planner/search/follow.h"
#include "planner/search/guesses.h"
#include "planner/search/motions.h"

namespace fjr {
namespace {

enum class WaitPlace { kStart, kOnTheWay, kGoal };

bool pays_for_torque(const TermInfo& term) { return term.sees_friction && term.settles_torque; }

// Returns whether torque is paid for, and nothing that a rest in which friction holds the arm would cost.
bool rests_cost_nothing(const Weights& weights) {
  const auto has = [&](const TermInfo& term) { return weights.*term.weight != 0; };
  return std::any_of(Terms::infos.begin(), Terms::infos.end(),
                     [&](const TermInfo& term) { return has(term) && pays_for_torque(term); }) &&
         std::all_of(Terms::infos.begin(), Terms::infos.end(), [&](const TermInfo& term) {
           return !has(term) || pays_for_torque(term) || term.sees_acceleration;
         });
}

// Returns whether friction holds the arm there without torque, at no more than this speed [rad/s].
bool is_held(const Parameters& robot, const Joints<double>& q, double speed) {
  const Joints<double> gravity = gravity_torque(robot, q);
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (std::abs(gravity[j]) > FrictionLaw::of(robot, static_cast<int>(j)).nonlinear(speed)) return false;
  }
  return true;
}

WaitPlace place_of_wait(const Problem& problem, const SpareTimeSettings& settings) {
  if (is_held(problem.robot, problem.start.q, settings.hardly_moving)) return WaitPlace::kStart;
  if (is_held(problem.robot, problem.goal.q, settings.hardly_moving)) return WaitPlace::kGoal;
  return WaitPlace::kOnTheWay;
}

// Returns the duration [s] of the shorter motion: of one way, or of two with a pause between them.
double enough_time(const Problem& problem, WaitPlace place, const SpareTimeSettings& settings) {
  const double one_way = settings.times_usual * usual_duration(problem);
  if (place != WaitPlace::kOnTheWay) return std::max(settings.one_motion, one_way);
  return std::max(settings.two_motions, one_way) + settings.pause;
}

// Returns the request in so much time [s], with a pause in the middle if the arm waits on the way.
Problem in_less_time(Problem problem, double time, WaitPlace place, const SpareTimeSettings& settings) {
  problem.duration = {time, time};
  if (place == WaitPlace::kOnTheWay) {
    problem.variation.pause = Pause{0.5 * (time - settings.pause), 0.5 * (time + settings.pause), settings.speed};
  }
  return problem;
}

// Returns the node at which the wait is put in: the first, the last, or one in the middle of the pause.
std::size_t node_of_wait(const Motion& motion, WaitPlace place) {
  const std::size_t count = motion.intervals.size();
  switch (place) {
    case WaitPlace::kStart:
      return 0;
    case WaitPlace::kOnTheWay:
      return motion.interval_at(0.5 * motion.duration());
    case WaitPlace::kGoal:
      return count;
  }
  return count;
}

// Returns a mesh of one segment with a wait of so many intervals inserted at a node.
Mesh with_wait(Mesh mesh, std::size_t node, double duration, double wait, std::size_t pieces) {
  const double whole = duration + wait;
  for (Mesh::Interval& interval : mesh.intervals) interval.fraction *= duration / whole;
  mesh.intervals.insert(mesh.intervals.begin() + static_cast<std::ptrdiff_t>(node), pieces,
                        {wait / whole / static_cast<double>(pieces), 0});
  return mesh;
}

// Returns an interval in which the arm stays in this state. The motors carry what the springs do.
Motion::Interval standing_still(const Parameters& robot, const State<double>& x, double start, double duration) {
  Motion::Interval rest{start, duration, Eigen::MatrixXd::Zero(kStates, 2), Eigen::MatrixXd::Zero(kControls, 2)};
  x.copy_to(rest.state.data());
  const Joints<double> held = spring_torque(robot, x.q, x.theta);
  std::copy(held.begin(), held.end(), rest.torque.data());
  return rest;
}

// Returns a motion of one segment with a wait [s] inserted at a node, without the report of its solve.
Collocated with_wait(const Parameters& robot, Collocated c, std::size_t node, double wait, std::size_t pieces) {
  c.setup.mesh = with_wait(std::move(c.setup.mesh), node, c.motion.duration(), wait, pieces);
  c.setup.margins.clear();
  c.setup.creep.clear();
  auto& intervals = c.motion.intervals;
  const double time = node < intervals.size() ? intervals[node].start : c.motion.duration();
  const State<double> x = c.motion.state_at(time);
  for (std::size_t k = node; k < intervals.size(); ++k) intervals[k].start += wait;
  intervals.insert(intervals.begin() + static_cast<std::ptrdiff_t>(node), standing_still(robot, x, time, wait));
  c.durations.front() += wait;
  c.report = {};
  return c;
}

// Refines motions in parallel. Returns those that were finished.
std::vector<Continuation> refined(std::vector<Continuation> all, Session& session) {
  std::vector<char> finished(all.size());  // not bool, whose elements share bytes that two threads would write
  const std::vector<PieceOfWork> pieces = session.do_all(all.size(), [&](std::size_t i, Session& own) {
    all[i].go_on_in(own);
    finished[i] = all[i].refine() == Completion::kFinished;
    all[i].go_on_in(session);
  });
  std::vector<Continuation> motions;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (pieces[i] == PieceOfWork::kCounts && finished[i]) motions.push_back(std::move(all[i]));
  }
  return motions;
}

// Solves the motion with its wait with the exact friction law, and from a smoothed one, which lets slower motions be
// found. That is followed to the exact law only if it is better at first. Returns the refined motions.
std::vector<Continuation> with_exact_friction(const std::shared_ptr<const Problem>& problem, const Collocated& waiting,
                                              Session& session) {
  const Timed timed(session, "finish");
  const SpareTimeSettings& s = session.settings().spare_time;
  const bool pauses = problem->variation.pause.has_value();
  const std::array<double, 2> widths{0, pauses ? s.width_of_pause : s.width_at_end};
  std::vector<std::optional<Continuation>> solved(widths.size());
  const auto pieces = session.do_all(widths.size(), [&](std::size_t i, Session& own) {
    Continuation c(problem, own, fmt::format("with a wait, from {:g} rad/s", widths[i]));
    const bool found = c.take_over(waiting, widths[i], pauses ? s.barrier_of_pause : s.barrier_at_end, s.iterations);
    c.go_on_in(session);
    if (found) solved[i] = std::move(c);
  });
  std::vector<Continuation> motions;
  for (std::size_t i = 0; i < solved.size(); ++i) {
    if (pieces[i] == PieceOfWork::kIgnored || !solved[i]) continue;
    const auto objective = [](const Continuation& c) { return c.solution().report.objective; };
    if (!motions.empty() && objective(*solved[i]) >= objective(motions.front())) continue;
    motions.push_back(*std::move(solved[i]));
  }
  return refined(std::move(motions), session);
}

bool suits(const Findings& found) {
  const Problem& asked = found.asked;
  return asked.duration.fixed() && found.alternatives.size() == 1 && rests_cost_nothing(asked.weights) &&
         asked.start_at_rest && asked.goal.at_rest && !asked.goal.any_free() && asked.via.empty() &&
         can_be_carried(asked);
}

// Allows as much work again as was done since `before` [s], so that as much as usual is left.
void give_back_work_since(double before, Session& session) {
  const double most = session.options().most_work;
  if (most > 0 && most < kNoLimit) session.allow_more((session.account().work - before) / most);
}

// The request in a short time, and the wait that is left of its own.
struct Shorter {
  Problem problem;
  WaitPlace place;
  double wait;  // [s]
};

// Returns nothing if there is hardly more time than that.
std::optional<Shorter> shortened(const Problem& asked, const SpareTimeSettings& settings) {
  const WaitPlace place = place_of_wait(asked, settings);
  const double time = enough_time(asked, place, settings);
  if (asked.duration.max < settings.worthwhile * time) return std::nullopt;
  if (sees_acceleration(asked.weights) && asked.duration.max < settings.accelerations_from) return std::nullopt;
  return Shorter{in_less_time(asked, time, place, settings), place, asked.duration.max - time};
}

// Plans the request from the motion in a short time. Returns nothing if no certified plan comes of it.
std::optional<Publication> planned_with_wait(const Collocated& motion, const Shorter& shorter, const Findings& found,
                                             Session& session) {
  const SpareTimeSettings& s = session.settings().spare_time;
  Problem longer = *found.alternatives.front();
  longer.variation.pause = shorter.problem.variation.pause;
  if (longer.variation.pause) longer.variation.pause->end += shorter.wait;
  const std::size_t pieces = longer.variation.pause ? s.intervals_of_pause : s.intervals_at_end;
  const Collocated waiting =
      with_wait(longer.robot, motion, node_of_wait(motion.motion, shorter.place), shorter.wait, pieces);
  Findings in_whole(found.asked, session.settings().follow);
  publish_best(with_exact_friction(std::make_shared<const Problem>(std::move(longer)), waiting, session), in_whole,
               session);
  return in_whole.certified() ? std::move(in_whole.best) : std::nullopt;
}

}  // namespace

WithWait plan_with_wait(int starts, Findings& found, Session& session) {
  if (!suits(found)) return {};
  const SpareTimeSettings& s = session.settings().spare_time;
  const std::optional<Shorter> shorter = shortened(found.asked, s);
  if (!shorter) return {};
  double before = session.account().work;
  Findings in_short(shorter->problem, session.settings().follow);
  find_motions(starts, IfNone::kGiveUp, in_short, session);
  give_back_work_since(before, session);
  if (!in_short.certified() || session.interrupted()) return {};

  before = session.account().work;
  WithWait result{planned_with_wait(in_short.best->solution, *shorter, found, session)};
  give_back_work_since(before, session);
  if (!result.best) return {};
  // Accelerations cost the less the longer a motion takes, so that one without a wait may be better.
  result.is_enough = shorter->place != WaitPlace::kOnTheWay && !sees_acceleration(found.asked.weights) &&
                     result.best->objective < s.costly_wait * in_short.best->objective;
  if (result.is_enough) {
    found.starts = in_short.starts;
    found.starts_planned = in_short.starts_planned;
    found.refined = in_short.refined;
    found.minima = in_short.minima;
  }
  return result;
}

}  // namespace fjr
