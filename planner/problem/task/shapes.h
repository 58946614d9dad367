// The kinds of task constraint as plain numbers. Each kind is defined in a file of its own in this folder, and task.h
// lists them.
#pragma once

#include <optional>
#include <vector>

#include "model/kinematics.h"
#include "model/parameters.h"

namespace fjr {

// Both links keep clear of a disc, by `margin` in addition to their radius, over their whole length. [m]
struct Disc {
  Coordinates center{};
  double radius = 0, margin = 0;
};

// Both links keep to one side of a straight line through `point`: a wall, a table, a fence. `normal`, of any length,
// points to where the arm may be; `margin` is kept beside the links' radius. [m]
struct Wall {
  Coordinates point{}, normal{};
  double margin = 0;
};

// The tip stays inside a box. [m]
struct TipBox {
  Coordinates lower{}, upper{};
};

// The tip stays within a tolerance of the straight line between two points. [m]
struct TipLine {
  Coordinates from{}, to{};
  double tolerance = 0;
};

enum class ArcWay { kShort, kLong };

// The tip stays within a tolerance of an arc about `center`, the short way from one point to another, or the long way
// round. [m]
struct TipArc {
  Coordinates center{}, from{}, to{};
  double tolerance = 0;
  ArcWay way = ArcWay::kShort;
};

// The links' angles stay within a tolerance of straight lines through the corners, one after the other. The motion has
// one segment per line. [rad]
struct JointPath {
  std::vector<Joints<double>> corners;  // from the start to the goal
  double tolerance = 0;
};

// Everything that both links keep clear of.
struct Obstacles {
  std::vector<Disc> discs;
  std::vector<Wall> walls;
};

// All task constraints of one motion.
struct Task {
  Obstacles obstacles;
  std::optional<TipBox> box;
  std::optional<TipLine> line;
  std::optional<TipArc> arc;
  std::optional<JointPath> path;
};

}  // namespace fjr
