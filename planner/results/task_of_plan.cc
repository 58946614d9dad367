#include "planner/results/task_of_plan.h"

#include <string_view>
#include <vector>

#include "planner/problem/task/task.h"

namespace fjr {
namespace {

void read(const JsonField& field, double& value) { value = field.number(); }
void read(const JsonField& field, Coordinates& pair) { pair = field.pair(); }
void read(const JsonField& field, ArcWay& way) { way = field.text() == "long" ? ArcWay::kLong : ArcWay::kShort; }
void read(const JsonField& field, std::vector<Joints<double>>& points) {
  for (const JsonField& point : field.items()) points.push_back(point.pair());
}
void read(const JsonField& field, TipBox& box) {
  const std::vector<JsonField> corners = field.items();
  if (corners.size() != 2) field.fail("must be a list of two corners");
  box = {corners[0].pair(), corners[1].pair()};
}

template <class Constraint>
void read(const JsonField& field, Constraint& constraint) {
  visit(constraint, [&](const Key& key, auto& member) {
    if (key.required()) {
      read(field.at(key.name), member);
    } else if (const auto given = field.find(key.name)) {
      read(*given, member);
    }
  });
}

}  // namespace

Task task_of_plan(const JsonField& plan) {
  const JsonField field = plan.at("resolved_request").at("task");
  Task task;
  visit_constraints(task, [&](const char* key, auto& member) {
    const auto found = field.find(key);
    if (!found) return;
    if constexpr (requires { member.size(); }) {
      for (const JsonField& item : found->items()) read(item, member.emplace_back());
    } else {
      read(*found, member.emplace());
    }
  });
  return task;
}

}  // namespace fjr
