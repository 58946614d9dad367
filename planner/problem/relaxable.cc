#include "planner/problem/relaxable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "planner/problem/task/task.h"

namespace fjr {
namespace {

constexpr double kMostTimes = 20;  // times a limit: nobody would build a robot beyond that

void add_limits(std::vector<Relaxable>& all, const Problem& problem) {
  const Limits robots = Limits::of(problem.robot);
  for (std::size_t i = 0; i < kLimits; ++i) {
    const LimitName& name = kLimitNames[i];
    const double limit = name.in(problem.limits);
    if (!std::isfinite(limit)) continue;
    Relaxable one{RelaxableKind::kLimit,
                  name.quantity->name,
                  name.joint,
                  name.quantity->unit,
                  limit,
                  1,
                  kMostTimes * limit,
                  name.in(robots)-limit,
                  [name](Problem& p, double value) { name.in(p.limits) = value; },
                  name.quantity};
    one.indices = {i};
    all.push_back(std::move(one));
  }
}

// Sets the relaxed number of one task constraint; its other numbers are restored from `as_it_was`.
template <class Constraint>
void relax(Problem& problem, std::size_t number, const Constraint& as_it_was, double value) {
  std::size_t next = 0;
  each_constraint(problem.task, [&](const std::string&, auto& constraint) {
    const bool meant = next++ == number;
    if constexpr (std::is_same_v<std::remove_reference_t<decltype(constraint)>, Constraint>) {
      if (!meant) return;
      if constexpr (std::is_same_v<Constraint, JointPath>) {  // corners are passed within a part of the tolerance
        for (Via& via : problem.via) via.tolerance *= value / constraint.tolerance;
      }
      constraint = as_it_was;
      relax(constraint, value);
    }
  });
}

void add_task(std::vector<Relaxable>& all, const Problem& problem) {
  const std::vector<TaskRow> rows = task_rows(problem.robot, problem.task, 0);
  std::size_t next = 0;
  each_constraint(problem.task, [&](const std::string& name, const auto& constraint) {
    const std::size_t number = next++;
    const ConstraintInfo& info = kInfo<std::decay_t<decltype(constraint)>>;
    const double from = relaxed_by(constraint), most = info.most > 0 ? info.most : from;
    const auto set = [number, constraint](Problem& p, double value) { relax(p, number, constraint, value); };
    Relaxable one{RelaxableKind::kConstraint,         name, 0,       info.unit, from,  info.sign, most,
                  info.sign > 0 ? most - from : most, set,  nullptr, &info,     number};
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (rows[r].constraint == number) one.indices.push_back(kLimits + r);
    }
    all.push_back(std::move(one));
  });
}

void add_velocities(std::vector<Relaxable>& all, const Problem& problem) {
  const auto add = [&](const std::string& name, std::size_t point, const Joints<double>& dq, auto&& target) {
    if (dq[0] == 0 && dq[1] == 0) return;
    const auto set = [dq, target](Problem& p, double value) {
      target(p) = Joints<double>{value * dq[0], value * dq[1]};
    };
    all.push_back({RelaxableKind::kVelocity, name, 0, "times", 1, -1, 1, 1, set, nullptr, nullptr, point});
  };
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    if (!problem.via[i].dq) continue;
    add(fmt::format("via[{}].dq", i), i, *problem.via[i].dq,
        [i](Problem& p) -> Joints<double>& { return *p.via[i].dq; });
  }
  if (!problem.goal.theta && !problem.goal.dtheta) {
    add(problem.goal.of_tip_velocity ? "goal.tip_velocity" : "goal.dq", problem.via.size(), problem.goal.dq,
        [](Problem& p) -> Joints<double>& { return p.goal.dq; });
  }
}

}  // namespace

std::vector<Relaxable> relaxables(const Problem& problem) {
  std::vector<Relaxable> all;
  add_limits(all, problem);
  add_task(all, problem);
  add_velocities(all, problem);
  return all;
}

Relaxable both_joints(const Problem& problem, const QuantityInfo& quantity) {
  const Joints<double> limit = problem.limits.*quantity.per_joint;
  const auto set = [limit, &quantity](Problem& p, double factor) {
    p.limits.*quantity.per_joint = {factor * limit[0], factor * limit[1]};
  };
  Relaxable both{RelaxableKind::kBothJoints, quantity.name, 0, "times", 1, 1, kMostTimes, 0, set, &quantity};
  for (std::size_t j = 0; j < kJoints; ++j) both.indices.push_back(first_limit_of(quantity) + j);
  const Joints<double> robots = Limits::of(problem.robot).*quantity.per_joint;
  both.allowed = std::min({kMostTimes, robots[0] / limit[0] - 1, robots[1] / limit[1] - 1});
  return both;
}

Relaxable all_limits(const Problem& problem) {
  const auto set = [limits = problem.limits](Problem& p, double factor) {
    for (const LimitName& name : kLimitNames) {
      if (!name.quantity->place) name.in(p.limits) = factor * name.in(limits);
    }
  };
  Relaxable all{RelaxableKind::kAllLimits, "all_limits", 0, "times", 1, 1, kMostTimes, 0, set};
  all.allowed = kMostTimes;
  const Limits robots = Limits::of(problem.robot);
  for (const LimitName& name : kLimitNames) {
    if (name.quantity->place) continue;  // as above
    const double limit = name.in(problem.limits);
    if (std::isfinite(limit)) all.allowed = std::min(all.allowed, name.in(robots) / limit - 1);
  }
  return all;
}

Problem relaxed(const Problem& problem, double fraction) {
  Problem result = problem;
  for (const Relaxable& r : relaxables(problem)) {
    if (r.kind == RelaxableKind::kVelocity) continue;
    r.set(result, r.value(std::min(r.most, fraction * r.size())));
  }
  return result;
}

}  // namespace fjr
