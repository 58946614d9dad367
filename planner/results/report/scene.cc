#include "planner/results/report/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "model/kinematics.h"
#include "planner/problem/task/task.h"
#include "planner/results/planned_motion.h"
#include "planner/results/report/html_table.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

Json tip_at(const Parameters& robot, const Joints<double>& q) {
  const Point<double> tip = tip_position(robot, q);
  return {tip.x, tip.y};
}

// Adds the via points. times: when the motion passes them; empty if there is no motion.
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

// ---- shapes ----

// The interface by which constraints draw themselves. Each shape has a function of the same name in plan_page.js.
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
  void curve(const std::vector<Coordinates>& points) {
    if (!points.empty()) add({{"kind", "curve"}, {"points", points}});
  }

 private:
  void add(Json shape) {
    shape["label"] = label;
    scene.push_back(std::move(shape));
  }
};

}  // namespace

Json scene_json(const JsonField& plan, const Parameters& robot) {
  Json scene = Json::array();
  const Task task = planned_task_in(plan.json(), plan.source());
  each_constraint(task, [&](std::string name, const auto& constraint) {
    std::replace(name.begin(), name.end(), '_', ' ');
    Drawing drawing{robot, name, scene};
    draw(constraint, drawing);
  });
  add_vias(plan.at("resolved_request").at("via"), plan.at("via_times").numbers(), robot, scene);
  return scene;
}

}  // namespace fjr
