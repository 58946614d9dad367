// What a request asks of the motion beside the limits: what to keep clear of, where the tip may be, a path to follow.
// A new task constraint takes a struct and its member of Obstacles or Task in shapes.h, a file of its own for what it
// means (constraint.h says what it has), and its line in visit_constraints() here; what both links keep clear of has a
// line in visit_obstacles() too, which makes it a key of requests. Reading, checking, hashing, optimising, margins, the
// certificate, explanations, shadow prices, plan.json and the pictures go by these lists.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "planner/problem/task/disc.h"
#include "planner/problem/task/joint_path.h"
#include "planner/problem/task/row.h"
#include "planner/problem/task/shapes.h"
#include "planner/problem/task/tip_arc.h"
#include "planner/problem/task/tip_box.h"
#include "planner/problem/task/tip_line.h"
#include "planner/problem/task/wall.h"

namespace fjr {

// visit(key, member) for every kind, of a Task that is const or not, in the order of the rows. Members are optional, or
// lists. key: in plan.json.
template <class T, class Visit>
void visit_constraints(T& task, Visit&& visit) {
  visit("path", task.path);
  visit("obstacles", task.obstacles.discs);
  visit("box", task.box);
  visit("line", task.line);
  visit("arc", task.arc);
  visit("walls", task.obstacles.walls);
}

// visit(list) for every kind of obstacle. Its key in requests, and in plan.json, is kRequestKey of the kind.
template <class List>
using kind_of_list = typename std::remove_cvref_t<List>::value_type;
template <class O, class Visit>
void visit_obstacles(O& obstacles, Visit&& visit) {
  visit(obstacles.discs);
  visit(obstacles.walls);
}

// How many there are of all kinds.
std::size_t count_of(const Obstacles& obstacles);

// ---- what follows from the list ----

template <class Constraint>
std::string name_of(const std::optional<Constraint>&, std::size_t) {
  return kInfo<Constraint>.name;
}
template <class Constraint>
std::string name_of(const std::vector<Constraint>&, std::size_t i) {
  return fmt::format("{}[{}]", kInfo<Constraint>.name, i);
}

// visit(name, constraint) for each that there is; name: as in messages and in plan.json, such as obstacles[0]. Their
// number in this order tells which one is meant.
template <class T, class Visit>
void each_constraint(T& task, Visit&& visit) {
  visit_constraints(task, [&](const char*, auto& member) {
    if constexpr (requires { member.size(); }) {
      for (std::size_t i = 0; i < member.size(); ++i) visit(name_of(member, i), member[i]);
    } else if (member) {
      visit(name_of(member, 0), *member);
    }
  });
}

// The number of a constraint, which is a member of the task or an element of one.
template <class Constraint>
std::size_t number_of(const Task& task, const Constraint& constraint) {
  std::size_t number = 0, found = 0;
  each_constraint(task, [&](const std::string&, const auto& other) {
    if (static_cast<const void*>(&other) == static_cast<const void*>(&constraint)) found = number;
    ++number;
  });
  return found;
}

// What the constraint of this number is called: obstacles[0], tip_box, ...
std::string constraint_name(const Task& task, std::size_t number);

// The rows of a task while the motion is in `segment` of its mesh: the same kinds at every segment, in the same order.
std::vector<TaskRow> task_rows(const Parameters& robot, const Task& task, std::size_t segment);

// The tolerance of a line less the arm's distance from it, ends included, by the line's two rows. [m or rad]
double left_of_line(const Parameters& robot, const TaskRow& across, const TaskRow& along, const Posture<double>& at);

// How many that are.
std::size_t count_of_rows(const Task& task);
inline constexpr std::size_t kMostObstacles = 64;                     // discs and walls together
inline constexpr std::size_t kMostTaskRows = 2 * kMostObstacles + 5;  // a path and a region of the tip beside them

// Whether there is something to keep clear of.
bool keeps_clear(const Task& task);

}  // namespace fjr
