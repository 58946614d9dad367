#include "planner/problem/task/task.h"

namespace fjr {
namespace {

// Returns whether any constraint is of a kind that says so of itself.
bool any_is(const Task& task, bool ConstraintInfo::*property) {
  bool any = false;
  each_constraint(task, [&](const std::string&, const auto& constraint) {
    any = any || kInfo<std::decay_t<decltype(constraint)>>.*property;
  });
  return any;
}

}  // namespace

std::vector<TaskRow> task_rows(const Parameters& robot, const Task& task, std::size_t segment) {
  std::vector<TaskRow> rows;
  std::size_t number = 0;
  each_constraint(task, [&](const std::string& name, const auto& constraint) {
    TaskRows to{robot, segment, name, &kInfo<std::decay_t<decltype(constraint)>>, number++, rows};
    add_rows(constraint, to);
  });
  return rows;
}

std::string constraint_name(const Task& task, std::size_t number) {
  std::string found;
  std::size_t next = 0;
  each_constraint(task, [&](const std::string& name, const auto&) {
    if (next++ == number) found = name;
  });
  return found;
}

double left_of_line(const Parameters& robot, const TaskRow& across, const TaskRow& along, const Posture<double>& at) {
  const double tolerance = along.scale, off = across.value(robot, at), where = along.value(robot, at);
  const double end = along.upper - task::kBeyond * tolerance, beyond = std::max({0.0, -where, where - end});
  return tolerance - std::hypot(off, beyond);
}

std::size_t count_of_rows(const Task& task) {
  std::size_t count = 0;
  each_constraint(task, [&](const std::string&, const auto& constraint) {
    if constexpr (requires { count_of_rows(constraint); }) {
      count += count_of_rows(constraint);
    } else {
      count += 2;
    }
  });
  return count;
}

std::size_t count_of(const Obstacles& obstacles) {
  std::size_t count = 0;
  visit_obstacles(obstacles, [&](const auto& list) { count += list.size(); });
  return count;
}

bool keeps_clear(const Task& task) { return any_is(task, &ConstraintInfo::keeps_clear); }

bool can_be_jumped_over(const Task& task) { return any_is(task, &ConstraintInfo::can_be_jumped_over); }

}  // namespace fjr
