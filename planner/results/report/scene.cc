#include "planner/results/report/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "model/kinematics.h"
#include "planner/problem/task/task.h"
#include "planner/results/report/html_table.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPiecesOfPath = 20;  // drawn of each line in joint space

Json tip_at(const Parameters& robot, const Joints<double>& q) {
  const Point<double> tip = tip_position(robot, q);
  return {tip.x, tip.y};
}

// times: when they are passed, of a plan that came to a motion.
void add_vias(const JsonField& vias, const std::vector<double>& times, const Parameters& robot, Json& scene) {
  const std::vector<JsonField> all = vias.items();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const JsonField& via = all[i];
    const double time = i < times.size() ? times[i] : via.at("time").number();
    scene.push_back({{"kind", "point"},
                     {"at", tip_at(robot, via.at("q").pair())},
                     {"label", std::isfinite(time) ? fmt::format("via, {} s", number_text(time)) : "via"}});
  }
}

// ---- the task, as plan.json has it ----

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

Task read_task(const JsonField& field) {
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

// ---- shapes ----

// What constraints draw themselves with; each shape is a function of that name in plan_page.js.
struct Drawing {
  const Parameters& robot;
  std::string label;
  Json& scene;

  void disc(const Coordinates& center, double radius, double margin) {
    add({{"kind", "disc"}, {"center", center}, {"radius", radius}, {"margin", margin}});
  }
  // normal: points to where the arm may be.
  void half_plane(const Coordinates& point, const Coordinates& normal) {
    add({{"kind", "wall"}, {"at", point}, {"normal", normal}});
  }
  void box(const Coordinates& lower, const Coordinates& upper) { add({{"kind", "box"}, {"corners", {lower, upper}}}); }
  void line(const Coordinates& from, const Coordinates& to, double tolerance) {
    add({{"kind", "line"}, {"from", from}, {"to", to}, {"tolerance", tolerance}});
  }
  // from, to: angles [rad].
  void arc(const Coordinates& center, double radius, double from, double to, double tolerance) {
    add({{"kind", "arc"},
         {"center", center},
         {"radius", radius},
         {"from", from},
         {"to", to},
         {"tolerance", tolerance}});
  }
  // Straight lines in joint space are curves of the tip.
  void joint_lines(const std::vector<Joints<double>>& corners) {
    Json points = Json::array();
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const Joints<double>&from = corners[i], &to = corners[i + 1];
      for (int k = 0; k <= kPiecesOfPath; ++k) {
        const double fraction = static_cast<double>(k) / kPiecesOfPath;
        points.push_back(
            tip_at(robot, {from[0] + fraction * (to[0] - from[0]), from[1] + fraction * (to[1] - from[1])}));
      }
    }
    if (!points.empty()) add({{"kind", "curve"}, {"points", std::move(points)}});
  }

 private:
  void add(Json shape) {
    shape["label"] = label;
    scene.push_back(std::move(shape));
  }
};

}  // namespace

Json scene_json(const JsonField& plan, const Parameters& robot) {
  const JsonField request = plan.at("resolved_request");
  Json scene = Json::array();
  const Task task = read_task(request.at("task"));
  each_constraint(task, [&](std::string name, const auto& constraint) {
    std::replace(name.begin(), name.end(), '_', ' ');
    Drawing drawing{robot, name, scene};
    draw(constraint, drawing);
  });
  add_vias(request.at("via"), plan.at("via_times").numbers(), robot, scene);
  return scene;
}

}  // namespace fjr
