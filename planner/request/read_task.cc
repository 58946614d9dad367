#include "planner/request/read_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/problem/tip_path.h"

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

Pair<double> read_point(const YamlNode& node) {
  const Pair<double> point = node.pair("m");
  for (std::size_t i = 0; i < 2; ++i) {
    if (std::abs(point[i]) > kLargestCoordinate) {
      node.fail_at(i, fmt::format("{} m is outside [{}, {}]", point[i], -kLargestCoordinate, kLargestCoordinate));
    }
  }
  return point;
}

double read_between(const YamlNode& node, double least, double most, std::string_view unit) {
  const double value = node.number(unit);
  if (value < least || value > most)
    node.fail(fmt::format("{} is outside [{}, {}]", with_unit(value, unit), least, most));
  return value;
}

double read_tolerance(const YamlNode& node, std::string_view unit) {
  return read_between(node.at("tolerance"), kLeastTolerance, kMostTolerance, unit);
}

double distance(const Pair<double>& a, const Pair<double>& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

std::vector<Disc> read_obstacles(const YamlNode& node) {
  const std::vector<YamlNode> items = node.items();
  if (items.size() > kMostObstacles) {
    node.fail(fmt::format("{} obstacles, above the {} allowed", items.size(), kMostObstacles));
  }
  std::vector<Disc> discs;
  for (const YamlNode& item : items) {
    item.allow_keys({"center", "radius", "margin"});
    Disc disc{read_point(item.at("center")), read_between(item.at("radius"), 0, kLargestCoordinate, "m"), 0};
    if (const auto margin = item.find("margin")) disc.margin = read_between(*margin, 0, kLargestCoordinate, "m");
    discs.push_back(disc);
  }
  return discs;
}

TipBox read_box(const YamlNode& node) {
  const std::vector<YamlNode> corners = node.items();
  if (corners.size() != 2) node.fail("must be two corners: [[x, y], [x, y]]");
  const TipBox box{read_point(corners[0]), read_point(corners[1])};
  for (std::size_t i = 0; i < 2; ++i) {
    if (box.upper[i] - box.lower[i] < kShortest) {
      corners[1].fail_at(
          i, fmt::format("{} m is not above the first corner's {} m (lower left first, then upper right)", box.upper[i],
                         box.lower[i]));
    }
  }
  return box;
}

TipLine read_line(const YamlNode& node) {
  node.allow_keys({"from", "to", "tolerance"});
  const TipLine line{read_point(node.at("from")), read_point(node.at("to")), read_tolerance(node, "m")};
  if (distance(line.from, line.to) < kShortest) node.at("to").fail("is the same point as from");
  return line;
}

bool read_long_way(const YamlNode& node) {
  const auto way = node.find("way");
  if (way && !way->says("short") && !way->says("long")) way->fail(shown(way->text()) + " is not one of short, long");
  return way && way->says("long");
}

TipArc read_arc(const YamlNode& node) {
  node.allow_keys({"center", "from", "to", "tolerance", "way"});
  const TipArc arc{read_point(node.at("center")), read_point(node.at("from")), read_point(node.at("to")),
                   read_tolerance(node, "m"), read_long_way(node)};
  const double radius = distance(arc.from, arc.center), other = distance(arc.to, arc.center);
  if (radius < kShortest) node.at("from").fail("is the center");
  if (std::abs(other - radius) > arc.tolerance) {
    node.at("to").fail(
        fmt::format("lies {:.6g} m from the center, from lies {:.6g} m from it; they may differ by the "
                    "tolerance of {} m",
                    other, radius, arc.tolerance));
  }
  if (distance(arc.from, arc.to) < kShortest)
    node.at("to").fail("is the same point as from; a full circle has no short way");
  const double turn = std::abs(turn_of(arc)), most = arc.long_way ? kMostLongTurn : kMostTurn;
  if (turn > most) {
    node.fail(fmt::format("turns by {:.4g} rad, above the {} rad allowed{}", turn, most,
                          arc.long_way ? "" : "; way: long is the other way round"));
  }
  if (arc.long_way) {
    const double gap = (2 * std::numbers::pi - turn) * radius;
    if (gap < kGapTolerances * arc.tolerance || arc.tolerance > radius / 2) {
      node.at("tolerance")
          .fail(fmt::format("{} m is too wide for an arc that leaves {:.4g} m of its circle", arc.tolerance, gap));
    }
  }
  return arc;
}

void read_tip(const YamlNode& node, Task& task) {
  node.allow_keys({"box", "line", "arc"});
  const auto box = node.find("box"), line = node.find("line"), arc = node.find("arc");
  if (int{box.has_value()} + int{line.has_value()} + int{arc.has_value()} != 1)
    node.fail("needs one of box, line, arc, and only one");
  if (box) task.box = read_box(*box);
  if (line) task.line = read_line(*line);
  if (arc) task.arc = read_arc(*arc);
}

void read_path(const YamlNode& node, const YamlNode& root, Problem& problem) {
  node.allow_keys({"points", "tolerance"});
  if (root.find("via")) node.fail("goes through its points already; give either path or via");
  if (problem.goal.any_free() || !problem.other_goals.empty()) {
    node.fail("needs a goal that is one place; give goal.q with two angles");
  }
  JointPath path{{problem.start.q}, read_tolerance(node, "rad")};
  if (const auto points = node.find("points")) {
    const std::vector<YamlNode> items = points->items();
    if (items.size() > kMostCorners)
      points->fail(fmt::format("{} points, above the {} allowed", items.size(), kMostCorners));
    for (const YamlNode& item : items) {
      const Pair<double> q = item.pair("rad");
      for (std::size_t j = 0; j < kJoints; ++j) {
        const double limit = problem.limits.link_position[j];
        if (std::abs(q[j]) > limit) item.fail_at(j, fmt::format("{} rad is outside [{}, {}]", q[j], -limit, limit));
      }
      if (distance(q, path.corners.back()) < kShortest) item.fail("is the same point as the one before it");
      path.corners.push_back(q);
      problem.via.push_back({std::nullopt, q, std::nullopt, kCornerShare * path.tolerance});
    }
  }
  if (distance(problem.goal.q, path.corners.back()) < kShortest)
    node.fail("ends where the goal is already; leave its last point out");
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

void read_task(const YamlNode& root, Problem& problem) {
  if (const auto obstacles = root.find("obstacles")) problem.task.obstacles = read_obstacles(*obstacles);
  if (const auto tip = root.find("tip")) read_tip(*tip, problem.task);
  if (const auto path = root.find("path")) read_path(*path, root, problem);
}

void check_task(const YamlNode& root, Problem& problem) {
  if (std::string wrong = broken(problem, 0, problem.start.q); !wrong.empty()) {
    throw InputError(root.source(), "start", wrong);
  }
  if (std::string wrong = leaves(problem, 0, problem.start.q, problem.start.dq); !wrong.empty()) {
    throw InputError(root.source(), "start.dq", wrong);
  }
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const std::string wrong = broken(problem, i, problem.via[i].q);
    if (!wrong.empty())
      throw InputError(root.source(), problem.task.path ? fmt::format("path.points[{}]", i) : fmt::format("via[{}]", i),
                       wrong);
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
  if (others.empty()) root.at("goal").fail(wrong);
  problem.goal = others.front();
  others.erase(others.begin());
}

}  // namespace fjr
