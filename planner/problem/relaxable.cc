#include "planner/problem/relaxable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fjr {
namespace {

constexpr double kMostTimes = 20;    // of a limit: beyond that nobody would build it
constexpr double kMostDistance = 1;  // [m] or [rad] of regions and paths
constexpr double kBoxSize = 0.1;     // [m] what shares of a box's growth are taken of

void add_limits(std::vector<Relaxable>& all, const Problem& problem) {
  const Limits robots = Limits::of(problem.robot);
  for (const LimitName& name : kLimitNames) {
    const double limit = name.in(problem.limits);
    if (!std::isfinite(limit)) continue;
    all.push_back({name.quantity->name, name.joint, name.quantity->unit, limit, 1, kMostTimes * limit,
                   name.in(robots)-limit, [name](Problem& p, double value) { name.in(p.limits) = value; }});
  }
}

void add_task(std::vector<Relaxable>& all, const Task& task) {
  for (std::size_t i = 0; i < task.obstacles.size(); ++i) {
    const double size = task.obstacles[i].radius + task.obstacles[i].margin;
    all.push_back({fmt::format("obstacles[{}]", i), 0, "m", size, -1, size, size, [i](Problem& p, double value) {
                     Disc& disc = p.task.obstacles[i];
                     disc.margin = std::min(disc.margin, value);
                     disc.radius = value - disc.margin;
                   }});
  }
  if (task.box) {
    all.push_back({"tip_box", 0, "m", 0, 1, kMostDistance, kMostDistance, [box = *task.box](Problem& p, double value) {
                     for (std::size_t i = 0; i < 2; ++i) {
                       p.task.box->lower[i] = box.lower[i] - value;
                       p.task.box->upper[i] = box.upper[i] + value;
                     }
                   }});
  }
  const auto add_tolerance = [&](const char* name, const char* unit, double tolerance, auto&& set) {
    all.push_back({name, 0, unit, tolerance, 1, kMostDistance, kMostDistance - tolerance, set});
  };
  if (task.line) {
    add_tolerance("tip_line", "m", task.line->tolerance, [](Problem& p, double v) { p.task.line->tolerance = v; });
  }
  if (task.arc) {
    add_tolerance("tip_arc", "m", task.arc->tolerance, [](Problem& p, double v) { p.task.arc->tolerance = v; });
  }
  if (task.path) {
    add_tolerance("path", "rad", task.path->tolerance, [](Problem& p, double v) {
      for (Via& via : p.via) via.tolerance *= v / p.task.path->tolerance;
      p.task.path->tolerance = v;
    });
  }
}

void add_velocities(std::vector<Relaxable>& all, const Problem& problem) {
  const auto add = [&](const std::string& name, const Pair<double>& dq, auto&& target) {
    if (dq[0] == 0 && dq[1] == 0) return;
    all.push_back({name, 0, "times", 1, -1, 1, 1, [dq, target](Problem& p, double value) {
                     target(p) = Pair<double>{value * dq[0], value * dq[1]};
                   }});
  };
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    if (!problem.via[i].dq) continue;
    add(fmt::format("via[{}].dq", i), *problem.via[i].dq, [i](Problem& p) -> Pair<double>& { return *p.via[i].dq; });
  }
  if (!problem.goal.theta && !problem.goal.dtheta) {
    add("goal.dq", problem.goal.dq, [](Problem& p) -> Pair<double>& { return p.goal.dq; });
  }
}

}  // namespace

std::vector<Relaxable> relaxables(const Problem& problem) {
  std::vector<Relaxable> all;
  add_limits(all, problem);
  add_task(all, problem.task);
  add_velocities(all, problem);
  return all;
}

Relaxable all_limits(const Problem& problem) {
  Relaxable all{"all_limits", 0, "times", 1, 1, kMostTimes, 0, [limits = problem.limits](Problem& p, double factor) {
                  for (const LimitName& name : kLimitNames) {
                    if (!name.quantity->place) name.in(p.limits) = factor * name.in(limits);
                  }
                }};
  all.allowed = kMostTimes;
  const Limits robots = Limits::of(problem.robot);
  for (const LimitName& name : kLimitNames) {
    const double limit = name.in(problem.limits);
    if (std::isfinite(limit)) all.allowed = std::min(all.allowed, name.in(robots) / limit - 1);
  }
  return all;
}

Problem relaxed(const Problem& problem, double share) {
  Problem result = problem;
  for (const Relaxable& r : relaxables(problem)) {
    if (r.unit == "times") continue;
    const double size = r.from > 0 ? r.from : kBoxSize;
    r.set(result, r.value(std::min(r.most, share * size)));
  }
  return result;
}

}  // namespace fjr
