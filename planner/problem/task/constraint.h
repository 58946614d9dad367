// Interface that all kinds of task constraint share.
//
// A kind is a struct of numbers in shapes.h. A file of its own defines:
//   template <> inline constexpr ConstraintInfo kInfo<Kind>{...};
//   add_rows(kind, TaskRows& to)       its rows at every point of the motion
//   check(kind, place)                 refuses bad values: place.at(key or index), place.fail(sentence)
//   relaxed_by(kind), relax(kind, to)  the number that is relaxed if the request is infeasible
//   draw(kind, in)                     its picture, in the shapes of results/report/scene.cc
//   count_of_rows(kind)                only if there are not two
//   visit(kind, v)                     its keys, unless it is written otherwise
//   template <> inline constexpr Key kRequestKey<Kind>{...};  for obstacles: the list in requests
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/key.h"
#include "common/strict_yaml.h"
#include "planner/problem/task/row.h"
#include "planner/problem/task/shapes.h"

namespace fjr {

struct ConstraintInfo {
  const char* name;  // name of its rows; numbered if there may be several
  // The key of requests below which its own stands, and with which its name then begins: `tip` of `tip_box`. Null:
  // none.
  const char* below = nullptr;
  bool keeps_clear = false;  // an obstacle, rather than a path or a region
  // An arm may pass through it between two nodes of a coarse mesh, and keep clear at both.
  bool can_be_jumped_over = false;
  bool is_band = false;  // about a path, and perhaps too narrow for the cells of a coarse grid
  double sign = 1;       // sign of a change that relaxes it
  double most = 1;       // [m] or [rad] largest change that makes sense; 0: the number itself
  const char* unit = "m";
  const char* relaxed = nullptr;  // message of a relaxation, {} the value; null: "would have to be {}"
};

template <class Kind>
extern const ConstraintInfo kInfo;
template <class Kind>
extern const Key kRequestKey;

// The rows under construction.
struct TaskRows {
  const Parameters& robot;
  std::size_t segment;
  std::string name;  // of the constraint, with its kind and its number, as in TaskRow
  const ConstraintInfo* info;
  std::size_t constraint;
  std::vector<TaskRow>& rows;

  void add(TaskRow::Kind kind, const std::array<double, 2>& vector, double number, double lower, double upper,
           double scale, int link = 0) {
    rows.push_back({kind, vector, number, lower, upper, scale, name, link, info, constraint});
  }
};

namespace task {

inline constexpr double kNone = std::numeric_limits<double>::infinity();
inline constexpr double kLargestCoordinate = 10;  // [m] well beyond the reach of any arm of this size
inline constexpr double kLeastTolerance = 1e-4,
                        kMostTolerance = 1;  // [m] or [rad]; the rollout is exact to about 6e-5 m
inline constexpr double kShortest = 1e-3;    // [m] or [rad] of lines, arcs and radii
inline constexpr double kArmScale = 0.1;  // [m] scale of the rows of regions without a size of their own that matters
// Fractions of the tolerance across the line and beyond its ends. A band of these sizes stays within the tolerance of
// the segment's ends too, corners included.
inline constexpr double kAcross = 0.99, kBeyond = 0.14;

// Coordinates, or the angles of the joints.
using Two = std::array<double, 2>;

inline Two difference(const Two& a, const Two& b) { return {a[0] - b[0], a[1] - b[1]}; }
inline double dot(const Two& a, const Two& b) { return a[0] * b[0] + a[1] * b[1]; }
inline double length(const Two& a) { return std::hypot(a[0], a[1]); }
inline double distance(const Two& a, const Two& b) { return length(difference(a, b)); }

template <class Place>
void check_between(const Place& place, double value, double least, double most, std::string_view unit) {
  if (value >= least && value <= most) return;
  place.fail(fmt::format("{} is outside [{}, {}]", with_unit(value, unit), least, most));
}

template <class Place>
void check_point(const Place& place, const Coordinates& point) {
  for (std::size_t i = 0; i < 2; ++i)
    check_between(place.at(i), point[i], -kLargestCoordinate, kLargestCoordinate, "m");
}

template <class Place>
void check_tolerance(const Place& place, double tolerance, std::string_view unit) {
  check_between(place.at("tolerance"), tolerance, kLeastTolerance, kMostTolerance, unit);
}

// Adds rows across and along the line from one point to another, within the tolerance.
inline void add_band(TaskRows& to, TaskRow::Kind kind, const Two& from, const Two& end, double tolerance) {
  const Two way = difference(end, from);
  const double far = length(way);
  const Two along{way[0] / far, way[1] / far}, across{-along[1], along[0]};
  to.add(kind, across, dot(across, from), -kAcross * tolerance, kAcross * tolerance, tolerance);
  const std::size_t row_across = to.rows.size() - 1;
  to.add(kind, along, dot(along, from), -kBeyond * tolerance, far + kBeyond * tolerance, tolerance);
  to.rows.back().across = row_across;
}

}  // namespace task
}  // namespace fjr
