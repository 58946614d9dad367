#include "planner/request/resolve_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "planner/problem/task/task.h"
#include "planner/request/place.h"
#include "planner/request/request_keys.h"

namespace fjr {
namespace {

using task::distance, task::kShortest;

constexpr double kCornerFraction = 0.1;  // fraction of the tolerance within which corners are passed
constexpr double kOnBound = 1e-6;        // fraction of a constraint's scale: as good as kept

void check_constraints(const Request& request, const Task& task) {
  visit_constraints(task, [&](const char* key, const auto& member) {
    const char* const below = kInfo<typename std::decay_t<decltype(member)>::value_type>.below;
    const Place place = below != nullptr ? Place{request, below}.at(key) : Place{request, key};
    if constexpr (requires { member.size(); }) {
      for (std::size_t i = 0; i < member.size(); ++i) check(member[i], place.at(i));
    } else if (member) {
      check(*member, place);
    }
  });
}

void check_count(const Request& request) {
  const std::size_t count = count_of(request.obstacles);
  if (count <= kMostObstacles) return;
  std::vector<std::string_view> kinds;
  std::string_view most;
  std::size_t longest = 0;
  visit_obstacles(request.obstacles, [&](const auto& list) {
    const std::string_view key = kRequestKey<kind_of_list<decltype(list)>>.name;
    if (!list.empty()) kinds.push_back(key);
    if (list.size() > longest) most = key;
    longest = std::max(longest, list.size());
  });
  Place{request, std::string(most)}.fail(
      fmt::format("{} {}, above the {} allowed", count, fmt::join(kinds, " and "), kMostObstacles));
}

// A corner between start and goal becomes a via point that is passed within a part of the tolerance.
void add_corner(const Place& place, const Joints<double>& q, JointPath& path, Problem& problem) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    check_angle(place.at(j), q[j], problem.limits.lowest(j), problem.limits.highest(j));
  }
  if (distance(q, path.corners.back()) < kShortest) place.fail("is the same point as the one before it");
  path.corners.push_back(q);
  problem.via.push_back({std::nullopt, q, std::nullopt, kCornerFraction * path.tolerance});
}

void resolve_path(const Request& request, const RequestedPath& asked, Problem& problem) {
  const Place place{request, "path"};
  if (problem.goal.any_free() || !problem.other_goals.empty()) {
    place.fail("needs a goal that is one place; give goal.q with two angles");
  }
  const std::vector<Joints<double>>& points = asked.points;
  JointPath path{{problem.start.q}, asked.tolerance};
  check(path, place);
  if (points.size() > kMostVias) {
    place.at("points").fail(fmt::format("{} points, above the {} allowed", points.size(), kMostVias));
  }
  for (std::size_t i = 0; i < points.size(); ++i) add_corner(place.at("points").at(i), points[i], path, problem);
  if (distance(problem.goal.q, path.corners.back()) < kShortest) {
    place.fail(points.empty() ? "start and goal are the same; a path between them needs a point"
                              : "ends where the goal is already; leave its last point out");
  }
  path.corners.push_back(problem.goal.q);
  problem.task.path = path;
}

// Returns what is wrong with the arm at q, if anything is.
std::optional<std::string> broken(const Problem& problem, std::size_t segment, const Joints<double>& q) {
  const auto posture = Posture<double>::of(problem.robot, q);
  for (const TaskRow& row : task_rows(problem.robot, problem.task, segment)) {
    const double clearance = row.distance(row.value(problem.robot, posture));
    if (clearance >= -kOnBound * row.scale) continue;
    if (row.link > 0) {
      return fmt::format("link {} would be {:.4g} m {} {}, its radius and margin included", row.link, -clearance,
                         row.is_distance() ? "beyond" : "inside", row.name);
    }
    if (row.kind == TaskRow::Kind::kAngles) return fmt::format("lies {:.4g} rad off the {}", -clearance, row.name);
    const std::string_view below = row.info->below;
    return fmt::format("puts the tip at [{:.4g}, {:.4g}] m, {:.4g} m outside {}.{}", posture.tip.x, posture.tip.y,
                       -clearance, below, row.name.substr(below.size() + 1));
  }
  return std::nullopt;
}

// Returns the region, if there is one, that a motion from q with velocity dq leaves at once because q lies on its
// bound.
std::optional<std::string> leaves(const Problem& problem, std::size_t segment, const Joints<double>& q,
                                  const Joints<double>& dq) {
  constexpr double kMoment = 1e-6;  // [s]
  const auto moved = [&](double time) { return Joints<double>{q[0] + time * dq[0], q[1] + time * dq[1]}; };
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double limit = problem.limits.link_position[j];
    const double middle = problem.limits.link_middle[j];
    if (std::abs(q[j] - middle) >= limit && std::abs(moved(kMoment)[j] - middle) > limit * (1 + 1e-12)) {
      return fmt::format("joint {} stands on its limit of {} rad and moves beyond it", j + 1,
                         middle == 0 ? limit : q[j]);
    }
  }
  const auto here = Posture<double>::of(problem.robot, q), soon = Posture<double>::of(problem.robot, moved(kMoment));
  for (const TaskRow& row : task_rows(problem.robot, problem.task, segment)) {
    const double clearance = row.clearance(row.value(problem.robot, here)),
                 then = row.clearance(row.value(problem.robot, soon));
    if (clearance <= kOnBound * row.scale && then < clearance - 1e-3 * kMoment) {  // faster than 1 mm/s or 1 mrad/s
      return fmt::format("lies on the edge of {} and moves beyond it", row.name);
    }
  }
  return std::nullopt;
}

// If the task forbids the guess of a joint that may end anywhere, which is its angle at the start, takes the angle that
// the task allows nearest to the joint's last given one.
void place_free_joint(Problem& problem) {
  constexpr int kAngles = 400;
  const std::size_t last = problem.via.size();
  if (!broken(problem, last, problem.goal.q)) return;
  const Joints<double> before = problem.via.empty() ? problem.start.q : problem.via.back().q;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!problem.goal.free[j]) continue;
    double nearest = kNoLimit;
    for (int i = -kAngles; i <= kAngles; ++i) {
      Joints<double> q = problem.goal.q;
      q[j] = problem.limits.link_middle[j] + problem.limits.link_position[j] * i / kAngles;
      if (std::abs(q[j] - before[j]) >= nearest || broken(problem, last, q)) continue;
      nearest = std::abs(q[j] - before[j]);
      problem.goal.q[j] = q[j];
    }
  }
}

}  // namespace

void resolve_task(const Request& request, Problem& problem) {
  check_count(request);
  Task& task = problem.task;
  task.obstacles = request.obstacles;
  if (request.tip) {
    auto [box, line, arc] = by_kind(*request.tip);
    std::tie(task.box, task.line, task.arc) = std::tie(box, line, arc);
  }
  check_constraints(request, task);
  if (const auto* path = std::get_if<RequestedPath>(&request.way)) resolve_path(request, *path, problem);
}

void check_task(const Request& request, Problem& problem) {
  const Place start{request, "start"};
  if (const auto wrong = broken(problem, 0, problem.start.q)) start.fail(*wrong);
  if (const auto wrong = leaves(problem, 0, problem.start.q, problem.start.dq)) start.at("dq").fail(*wrong);
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    const auto wrong = broken(problem, i, problem.via[i].q);
    if (wrong) Place{request, problem.task.path ? "path.points" : "via"}.at(i).fail(*wrong);
  }
  if (problem.goal.any_free()) return place_free_joint(problem);
  const std::size_t last = problem.via.size();
  // Before the goal the motion is where the reversed velocity leads to from it.
  const auto wrong_with = [&](const Goal& goal) {
    const auto there = broken(problem, last, goal.q);
    return there ? there : leaves(problem, last, goal.q, {-goal.dq[0], -goal.dq[1]});
  };
  const std::optional<std::string> wrong = wrong_with(problem.goal);
  std::vector<Goal>& others = problem.other_goals;
  std::erase_if(others, [&](const Goal& goal) { return wrong_with(goal).has_value(); });
  if (!wrong) return;
  if (others.empty()) Place{request, "goal"}.fail(*wrong);
  problem.goal = others.front();
  others.erase(others.begin());
}

}  // namespace fjr
