#include "planner/request/resolve_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/problem/tip_path.h"
#include "planner/request/place.h"

namespace fjr {
namespace {

constexpr double kLargestCoordinate = 10;                     // [m] well beyond the reach of any arm of this size
constexpr double kLeastTolerance = 1e-4, kMostTolerance = 1;  // [m] or [rad]; the rollout is exact to about 6e-5 m
constexpr double kShortest = 1e-3;                            // [m] or [rad] of lines, arcs and radii
constexpr std::size_t kMostCorners = 32;                      // as many as via points
constexpr double kMostTurn = 3.0;                             // [rad] of an arc: half a turn has no short way
constexpr double kMostLongTurn = 5.5;                         // [rad] the long way: a gap has to be left
constexpr double kGapTolerances = 4;                          // that the gap left by a long arc is wide at least
constexpr double kCornerShare = 0.1;                          // of the tolerance, in which a corner is passed
constexpr double kOnBound = 1e-6;                             // share of a constraint's scale: as good as kept

void check_between(const Place& place, double value, double least, double most, std::string_view unit) {
  if (value >= least && value <= most) return;
  place.fail(fmt::format("{} is outside [{}, {}]", with_unit(value, unit), least, most));
}

void check_point(const Place& place, const Pair<double>& point) {
  for (std::size_t i = 0; i < 2; ++i)
    check_between(place.at(i), point[i], -kLargestCoordinate, kLargestCoordinate, "m");
}

void check_tolerance(const Place& place, double tolerance, std::string_view unit) {
  check_between(place.at("tolerance"), tolerance, kLeastTolerance, kMostTolerance, unit);
}

double distance(const Pair<double>& a, const Pair<double>& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

void check_obstacles(const Place& place, const std::vector<Disc>& discs) {
  if (discs.size() > kMostObstacles) {
    place.fail(fmt::format("{} obstacles, above the {} allowed", discs.size(), kMostObstacles));
  }
  for (std::size_t i = 0; i < discs.size(); ++i) {
    check_point(place.at(i).at("center"), discs[i].center);
    check_between(place.at(i).at("radius"), discs[i].radius, 0, kLargestCoordinate, "m");
    check_between(place.at(i).at("margin"), discs[i].margin, 0, kLargestCoordinate, "m");
  }
}

void check_box(const Place& place, const TipBox& box) {
  check_point(place.at(0), box.lower);
  check_point(place.at(1), box.upper);
  for (std::size_t i = 0; i < 2; ++i) {
    if (box.upper[i] - box.lower[i] >= kShortest) continue;
    place.at(1).at(i).fail(fmt::format("{} m is not above the first corner's {} m (lower left first, then upper right)",
                                       box.upper[i], box.lower[i]));
  }
}

void check_line(const Place& place, const TipLine& line) {
  check_point(place.at("from"), line.from);
  check_point(place.at("to"), line.to);
  check_tolerance(place, line.tolerance, "m");
  if (distance(line.from, line.to) < kShortest) place.at("to").fail("is the same point as from");
}

// Half a turn has no short way, and a long way needs a gap that is left out.
void check_turn(const Place& place, const TipArc& arc, double radius) {
  const bool is_long = arc.way == ArcWay::kLong;
  const double turn = std::abs(turn_of(arc)), most = is_long ? kMostLongTurn : kMostTurn;
  if (turn > most) {
    place.fail(fmt::format("turns by {:.4g} rad, above the {} rad allowed{}", turn, most,
                           is_long ? "" : "; way: long is the other way round"));
  }
  const double gap = (2 * std::numbers::pi - turn) * radius;
  if (is_long && (gap < kGapTolerances * arc.tolerance || arc.tolerance > radius / 2)) {
    place.at("tolerance")
        .fail(fmt::format("{} m is too wide for an arc that leaves {:.4g} m of its circle", arc.tolerance, gap));
  }
}

void check_arc(const Place& place, const TipArc& arc) {
  check_point(place.at("center"), arc.center);
  check_point(place.at("from"), arc.from);
  check_point(place.at("to"), arc.to);
  check_tolerance(place, arc.tolerance, "m");
  const double radius = distance(arc.from, arc.center), other = distance(arc.to, arc.center);
  if (radius < kShortest) place.at("from").fail("is the center");
  if (std::abs(other - radius) > arc.tolerance) {
    place.at("to").fail(
        fmt::format("lies {:.6g} m from the center, from lies {:.6g} m from it; they may differ by the "
                    "tolerance of {} m",
                    other, radius, arc.tolerance));
  }
  if (distance(arc.from, arc.to) < kShortest) {
    place.at("to").fail("is the same point as from; a full circle has no short way");
  }
  check_turn(place, arc, radius);
}

void resolve_tip(const Request& request, Task& task) {
  const Place place{request, "tip"};
  const auto& [box, line, arc] = *request.tip;
  if (box) check_box(place.at("box"), *box);
  if (line) check_line(place.at("line"), *line);
  if (arc) check_arc(place.at("arc"), *arc);
  task.box = box;
  task.line = line;
  task.arc = arc;
}

// A corner between start and goal becomes a via point that is passed within a part of the tolerance.
void add_corner(const Place& place, const Pair<double>& q, JointPath& path, Problem& problem) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double limit = problem.limits.link_position[j];
    check_between(place.at(j), q[j], -limit, limit, "rad");
  }
  if (distance(q, path.corners.back()) < kShortest) place.fail("is the same point as the one before it");
  path.corners.push_back(q);
  problem.via.push_back({std::nullopt, q, std::nullopt, kCornerShare * path.tolerance});
}

void resolve_path(const Request& request, Problem& problem) {
  const Place place{request, "path"};
  if (!request.via.empty()) place.fail("goes through its points already; give either path or via");
  if (problem.goal.any_free() || !problem.other_goals.empty()) {
    place.fail("needs a goal that is one place; give goal.q with two angles");
  }
  const std::vector<Pair<double>>& points = request.path->points;
  JointPath path{{problem.start.q}, request.path->tolerance};
  check_tolerance(place, path.tolerance, "rad");
  if (points.size() > kMostCorners) {
    place.at("points").fail(fmt::format("{} points, above the {} allowed", points.size(), kMostCorners));
  }
  for (std::size_t i = 0; i < points.size(); ++i) add_corner(place.at("points").at(i), points[i], path, problem);
  if (distance(problem.goal.q, path.corners.back()) < kShortest) {
    place.fail("ends where the goal is already; leave its last point out");
  }
  path.corners.push_back(problem.goal.q);
  problem.task.path = path;
}

// What is wrong at q, empty if nothing is.
std::string broken(const Problem& problem, std::size_t segment, const Pair<double>& q) {
  const auto posture = Posture<double>::of(problem.robot, q);
  for (const TaskRow& row : task_rows(problem.robot, problem.task, segment)) {
    const double room = row.distance(row.value(problem.robot, posture));
    if (room >= -kOnBound * row.scale) continue;
    if (row.link > 0) {
      return fmt::format("link {} would be {:.4g} m inside {}, its radius and margin included", row.link, -room,
                         row.name);
    }
    if (row.kind == TaskRow::Kind::kAngles) return fmt::format("lies {:.4g} rad off the {}", -room, row.name);
    const std::string region = row.name.substr(std::string_view("tip_").size());
    return fmt::format("puts the tip at [{:.4g}, {:.4g}] m, {:.4g} m outside tip.{}", posture.tip.x, posture.tip.y,
                       -room, region);
  }
  return "";
}

// What a motion from q with velocity dq leaves at once, because q lies on its bound; empty if nothing.
std::string leaves(const Problem& problem, std::size_t segment, const Pair<double>& q, const Pair<double>& dq) {
  constexpr double kMoment = 1e-6;  // [s]
  const auto moved = [&](double time) { return Pair<double>{q[0] + time * dq[0], q[1] + time * dq[1]}; };
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double limit = problem.limits.link_position[j];
    if (std::abs(q[j]) >= limit && std::abs(moved(kMoment)[j]) > limit * (1 + 1e-12)) {
      return fmt::format("joint {} stands on its limit of {} rad and moves beyond it", j + 1, limit);
    }
  }
  const auto here = Posture<double>::of(problem.robot, q), soon = Posture<double>::of(problem.robot, moved(kMoment));
  for (const TaskRow& row : task_rows(problem.robot, problem.task, segment)) {
    const double room = row.room(row.value(problem.robot, here)), then = row.room(row.value(problem.robot, soon));
    if (room <= kOnBound * row.scale && then < room - 1e-3 * kMoment) {  // faster than 1 mm/s or 1 mrad/s
      return fmt::format("lies on the edge of {} and moves beyond it", row.name);
    }
  }
  return "";
}

// A joint that may end anywhere is guessed where it was last, or as near to that as the task allows.
void place_free_joint(Problem& problem) {
  constexpr int kAngles = 400;
  const std::size_t last = problem.via.size();
  if (broken(problem, last, problem.goal.q).empty()) return;
  const Pair<double> before = problem.via.empty() ? problem.start.q : problem.via.back().q;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!problem.goal.free[j]) continue;
    double nearest = kNoLimit;
    for (int i = -kAngles; i <= kAngles; ++i) {
      Pair<double> q = problem.goal.q;
      q[j] = problem.limits.link_position[j] * i / kAngles;
      if (std::abs(q[j] - before[j]) >= nearest || !broken(problem, last, q).empty()) continue;
      nearest = std::abs(q[j] - before[j]);
      problem.goal.q[j] = q[j];
    }
  }
}

}  // namespace

void resolve_task(const Request& request, Problem& problem) {
  problem.task.obstacles = request.obstacles;
  check_obstacles({request, "obstacles"}, request.obstacles);
  if (request.tip) resolve_tip(request, problem.task);
  if (request.path) resolve_path(request, problem);
}

void check_task(const Request& request, Problem& problem) {
  const Place start{request, "start"};
  if (std::string wrong = broken(problem, 0, problem.start.q); !wrong.empty()) start.fail(wrong);
  if (std::string wrong = leaves(problem, 0, problem.start.q, problem.start.dq); !wrong.empty()) {
    start.at("dq").fail(wrong);
  }
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const std::string wrong = broken(problem, i, problem.via[i].q);
    if (!wrong.empty()) Place{request, problem.task.path ? "path.points" : "via"}.at(i).fail(wrong);
  }
  if (problem.goal.any_free()) return place_free_joint(problem);
  const std::size_t last = problem.via.size();
  const auto wrong_with = [&](const Goal& goal) {  // before the goal the motion comes from where it goes to after it
    const std::string there = broken(problem, last, goal.q);
    return there.empty() ? leaves(problem, last, goal.q, {-goal.dq[0], -goal.dq[1]}) : there;
  };
  const std::string wrong = wrong_with(problem.goal);
  std::vector<Goal>& others = problem.other_goals;
  std::erase_if(others, [&](const Goal& goal) { return !wrong_with(goal).empty(); });
  if (wrong.empty()) return;
  if (others.empty()) Place{request, "goal"}.fail(wrong);
  problem.goal = others.front();
  others.erase(others.begin());
}

}  // namespace fjr
