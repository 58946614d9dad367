#include "planner/problem/task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fjr {
namespace {

using Kind = TaskRow::Kind;

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kBoxScale = 0.1;  // [m] a box has no size of its own that matters: the arm's
// A band of the full width that reaches this share of it beyond its ends stays within the full width of its segment's
// ends too, corners included.
constexpr double kAcross = 0.99, kBeyond = 0.14;

Pair<double> difference(const Pair<double>& a, const Pair<double>& b) { return {a[0] - b[0], a[1] - b[1]}; }
double dot(const Pair<double>& a, const Pair<double>& b) { return a[0] * b[0] + a[1] * b[1]; }
double length(const Pair<double>& a) { return std::hypot(a[0], a[1]); }

// Across and along the line from one point to another, within the tolerance.
void add_band(std::vector<TaskRow>& rows, Kind kind, const Pair<double>& from, const Pair<double>& to, double tolerance,
              const std::string& name) {
  const Pair<double> way = difference(to, from);
  const double far = length(way);
  const Pair<double> along{way[0] / far, way[1] / far}, across{-along[1], along[0]};
  rows.push_back({kind, across, dot(across, from), -kAcross * tolerance, kAcross * tolerance, tolerance, name});
  rows.push_back({kind, along, dot(along, from), -kBeyond * tolerance, far + kBeyond * tolerance, tolerance, name});
}

void add_obstacles(std::vector<TaskRow>& rows, const Parameters& robot, const std::vector<Disc>& discs) {
  for (std::size_t i = 0; i < discs.size(); ++i) {
    for (int link = 1; link <= kJoints; ++link) {
      const Kind kind = link == 1 ? Kind::kClearance1 : Kind::kClearance2;
      const double apart = discs[i].radius + discs[i].margin + robot.link.radius[static_cast<std::size_t>(link - 1)];
      rows.push_back({kind, discs[i].center, apart, 0, kNone, apart, fmt::format("obstacles[{}]", i), link});
    }
  }
}

void add_box(std::vector<TaskRow>& rows, const TipBox& box) {
  for (std::size_t i = 0; i < 2; ++i) {
    const Pair<double> axis{i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0};
    rows.push_back({Kind::kTip, axis, 0, box.lower[i], box.upper[i], kBoxScale, "tip_box"});
  }
}

// Beyond half a turn both lines across would cut the arc itself. What it leaves of the circle, less than half a turn,
// is then barred by a disc about its middle that reaches nearly to both ends.
void add_gap(std::vector<TaskRow>& rows, const TipArc& arc, double radius) {
  const Pair<double> chord{(arc.from[0] + arc.to[0]) / 2 - arc.center[0],
                           (arc.from[1] + arc.to[1]) / 2 - arc.center[1]};
  const Pair<double> middle{arc.center[0] + chord[0] * radius / length(chord),
                            arc.center[1] + chord[1] * radius / length(chord)};
  const double apart =
      std::min(length(difference(arc.from, middle)), length(difference(arc.to, middle))) - kBeyond * arc.tolerance;
  rows.push_back({Kind::kTipRadius, middle, apart, 0, kNone, arc.tolerance, "tip_arc"});
}

// Near the circle, after the line across it at one end and before the one at the other.
void add_arc(std::vector<TaskRow>& rows, const TipArc& arc) {
  const Pair<double> first = difference(arc.from, arc.center), last = difference(arc.to, arc.center);
  const double radius = length(first), band = kAcross * arc.tolerance, beyond = kBeyond * arc.tolerance;
  const auto from_circle = [radius](double r) { return (r * r - radius * radius) / (2 * radius); };
  rows.push_back({Kind::kTipRadius, arc.center, radius, radius > band ? from_circle(radius - band) : -kNone,
                  from_circle(radius + band), arc.tolerance, "tip_arc"});
  if (arc.way == ArcWay::kLong) return add_gap(rows, arc, radius);
  const double turn = first[0] * last[1] - first[1] * last[0] > 0 ? 1 : -1;
  const auto onward = [turn](const Pair<double>& r) {
    return Pair<double>{-turn * r[1] / length(r), turn * r[0] / length(r)};
  };
  const Pair<double> at_from = onward(first), at_to = onward(last);
  rows.push_back({Kind::kTip, at_from, dot(at_from, arc.from), -beyond, kNone, arc.tolerance, "tip_arc"});
  rows.push_back({Kind::kTip, at_to, dot(at_to, arc.to), -kNone, beyond, arc.tolerance, "tip_arc"});
}

}  // namespace

std::vector<TaskRow> task_rows(const Parameters& robot, const Task& task, std::size_t segment) {
  std::vector<TaskRow> rows;
  if (task.path) {
    const std::vector<Pair<double>>& corners = task.path->corners;
    add_band(rows, Kind::kAngles, corners[segment], corners[segment + 1], task.path->tolerance, "path");
  }
  add_obstacles(rows, robot, task.obstacles);
  if (task.box) add_box(rows, *task.box);
  if (task.line) add_band(rows, Kind::kTip, task.line->from, task.line->to, task.line->tolerance, "tip_line");
  if (task.arc) add_arc(rows, *task.arc);
  return rows;
}

std::size_t count_of_rows(const Task& task) {
  return (task.path ? 2 : 0) + kJoints * task.obstacles.size() + (task.box ? 2 : 0) + (task.line ? 2 : 0) +
         (!task.arc                        ? 0
          : task.arc->way == ArcWay::kLong ? 2
                                           : 3);
}

}  // namespace fjr
