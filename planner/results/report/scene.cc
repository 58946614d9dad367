#include "planner/results/report/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "model/kinematics.h"
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

void add_obstacles(const JsonField& obstacles, Json& scene) {
  const std::vector<JsonField> all = obstacles.items();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const JsonField& disc = all[i];
    scene.push_back({{"kind", "disc"},
                     {"center", disc.at("center").pair()},
                     {"radius", disc.at("radius").number()},
                     {"margin", disc.at("margin").number()},
                     {"label", fmt::format("obstacles[{}]", i)}});
  }
}

void add_walls(const JsonField& walls, Json& scene) {
  const std::vector<JsonField> all = walls.items();
  for (std::size_t i = 0; i < all.size(); ++i) {
    scene.push_back({{"kind", "wall"},
                     {"at", all[i].at("point").pair()},
                     {"normal", all[i].at("normal").pair()},
                     {"label", fmt::format("walls[{}]", i)}});
  }
}

// The short way round from one point to the other, or the long way.
Json arc_json(const JsonField& arc) {
  const Coordinates center = arc.at("center").pair(), from = arc.at("from").pair(), to = arc.at("to").pair();
  const double begin = std::atan2(from[1] - center[1], from[0] - center[0]);
  const double least = std::remainder(std::atan2(to[1] - center[1], to[0] - center[0]) - begin, 2 * std::numbers::pi);
  const double turn = arc.find("way") ? least - std::copysign(2 * std::numbers::pi, least) : least;
  return {{"kind", "arc"},     {"center", center},   {"radius", std::hypot(from[0] - center[0], from[1] - center[1])},
          {"from", begin},     {"to", begin + turn}, {"tolerance", arc.at("tolerance").number()},
          {"label", "tip arc"}};
}

void add_tip(const JsonField& task, Json& scene) {
  if (const auto box = task.find("box")) {
    const std::vector<JsonField> corners = box->items();
    if (corners.size() != 2) box->fail("must be a list of two corners");
    scene.push_back({{"kind", "box"}, {"corners", {corners[0].pair(), corners[1].pair()}}, {"label", "tip box"}});
  }
  if (const auto line = task.find("line")) {
    scene.push_back({{"kind", "line"},
                     {"from", line->at("from").pair()},
                     {"to", line->at("to").pair()},
                     {"tolerance", line->at("tolerance").number()},
                     {"label", "tip line"}});
  }
  if (const auto arc = task.find("arc")) scene.push_back(arc_json(*arc));
}

// Straight lines in joint space are curves of the tip.
void add_path(const JsonField& path, const Parameters& robot, Json& scene) {
  const std::vector<JsonField> corners = path.at("corners").items();
  Json points = Json::array();
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Joints<double> from = corners[i].pair(), to = corners[i + 1].pair();
    for (int k = 0; k <= kPiecesOfPath; ++k) {
      const double fraction = static_cast<double>(k) / kPiecesOfPath;
      points.push_back(tip_at(robot, {from[0] + fraction * (to[0] - from[0]), from[1] + fraction * (to[1] - from[1])}));
    }
  }
  if (!points.empty()) scene.push_back({{"kind", "curve"}, {"points", std::move(points)}, {"label", "path"}});
}

}  // namespace

Json scene_json(const JsonField& plan, const Parameters& robot) {
  const JsonField request = plan.at("resolved_request"), task = request.at("task");
  Json scene = Json::array();
  if (const auto obstacles = task.find("obstacles")) add_obstacles(*obstacles, scene);
  if (const auto walls = task.find("walls")) add_walls(*walls, scene);
  add_tip(task, scene);
  if (const auto path = task.find("path")) add_path(*path, robot, scene);
  add_vias(request.at("via"), plan.at("via_times").numbers(), robot, scene);
  return scene;
}

}  // namespace fjr
