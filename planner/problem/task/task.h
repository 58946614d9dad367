// The task of a request: obstacles to keep clear of, regions of the tip, paths to follow. A new constraint needs a
// struct and its member of Obstacles or Task in shapes.h, a file of its own (constraint.h says what it defines), and
// its line in visit_constraints() here. An obstacle also needs a line in visit_obstacles(), which makes it a key of
// requests. Reading, checking, hashing, optimising, margins, the certificate, explanations, shadow prices, plan.json
// and the pictures use these lists.
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

// Calls visit(key, member) for every kind, of a Task that is const or not, in the order of the rows. Members are
// optionals or lists. key: in plan.json.
template <class T, class Visit>
void visit_constraints(T& task, Visit&& visit) {
  visit("path", task.path);
  visit("obstacles", task.obstacles.discs);
  visit("box", task.box);
  visit("line", task.line);
  visit("arc", task.arc);
  visit("walls", task.obstacles.walls);
}

// Calls visit(list) for every kind of obstacle. Its key in requests, and in plan.json, is kRequestKey of the kind.
template <class List>
using kind_of_list = typename std::remove_cvref_t<List>::value_type;
template <class O, class Visit>
void visit_obstacles(O& obstacles, Visit&& visit) {
  visit(obstacles.discs);
  visit(obstacles.walls);
}

// Returns the number of obstacles of all kinds.
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

// Calls visit(name, constraint) for each constraint of the task; name: as in messages and in plan.json, such as
// obstacles[0]. Its number is its position in this order.
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

// Returns the number of a constraint, which is a member of the task or an element of one.
template <class Constraint>
std::size_t number_of(const Task& task, const Constraint& constraint) {
  std::size_t number = 0, found = 0;
  each_constraint(task, [&](const std::string&, const auto& other) {
    if (static_cast<const void*>(&other) == static_cast<const void*>(&constraint)) found = number;
    ++number;
  });
  return found;
}

// Returns the name of the constraint of this number: obstacles[0], tip_box, ...
std::string constraint_name(const Task& task, std::size_t number);

// Returns the rows of a task in `segment` of the motion: the same kinds in every segment, in the same order.
std::vector<TaskRow> task_rows(const Parameters& robot, const Task& task, std::size_t segment);

// Returns the tolerance of a line less the arm's distance from it, ends included, by the line's two rows. [m or rad]
double left_of_line(const Parameters& robot, const TaskRow& across, const TaskRow& along, const Posture<double>& at);

// Returns the number of these rows.
std::size_t count_of_rows(const Task& task);
inline constexpr std::size_t kMostObstacles = 64;                     // discs and walls together
inline constexpr std::size_t kMostTaskRows = 2 * kMostObstacles + 5;  // a path and a region of the tip beside them

// Returns whether the task has obstacles.
bool keeps_clear(const Task& task);

// Returns whether it has any that an arm may pass through between the nodes of a coarse mesh.
bool can_be_jumped_over(const Task& task);

}  // namespace fjr
