#include "planner/certificate/proof/task_reaches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fjr {
namespace {

using enclosure::Active;
using enclosure::Ball;
using enclosure::Polynomial;
using enclosure::rounded_up;

constexpr int kMostLinkHalvings = 40;
constexpr double kResolvedEnd = 1e-3;  // fraction of what a square may miss that the distance from a link's end may add

Active dot(const Point<Active>& a, const Point<Active>& b) { return a.x * b.x + a.y * b.y; }
Point<Active> minus(const Point<Active>& a, const Point<Active>& b) { return {a.x - b.x, a.y - b.y}; }

// Encloses the values of c over [0, length].
Ball over(const Polynomial& c, double length) {
  const double half = rounded_up(length / 2);
  const Polynomial middle = enclosure::shifted(c, half);
  double spread = 0;
  for (std::size_t k = middle.size(); k-- > 1;) spread = rounded_up((spread + middle[k].magnitude()) * half);
  return {middle[0].mid, rounded_up(middle[0].rad + spread)};
}

// Lower and upper bounds of a square root.
double root_below(double square) { return square <= 0 ? 0 : std::sqrt(square) * (1 - 4 * enclosure::kUnit); }
double root_above(double square) { return square <= 0 ? 0 : rounded_up(std::sqrt(square)); }

}  // namespace

TaskReaches::Side TaskReaches::Side::make(const TaskRow& row, Of of, bool is_lower, std::size_t output, double length,
                                          double may_miss) {
  const double bound = is_lower ? row.lower : row.upper;
  if (of == Of::kValue)
    return {row, of, is_lower, output, length, bound, may_miss, Reach::of_values(may_miss, row.scale)};
  // value = (distance^2 - number^2) / (2 number)
  const Ball number = row.number, square = enclosure::square(number) + 2.0 * number * Ball(bound);
  const Ball distance = root_below(square.lower()), miss = may_miss;
  // distance^2 - (distance - miss)^2, or (distance + miss)^2 - distance^2
  const double allowed = (2.0 * miss * distance + (is_lower ? -1.0 : 1.0) * enclosure::square(miss)).lower();
  return {row, of, is_lower, output, length, square, may_miss, Reach::of_values(allowed, 2 * row.scale * row.number)};
}

Polynomial TaskReaches::Side::beyond(Polynomial value) const {
  if (is_lower) {
    for (Ball& c : value) c = -c;
    value[0] += bound;
  } else {
    value[0] -= bound;
  }
  return value;
}

double TaskReaches::Side::clearance() const {
  const double most = shortfall.bound();
  if (of == Of::kValue || !std::isfinite(most)) return -most;
  if (is_lower) return root_below((bound - Ball(most)).lower()) - root_above(bound.upper());
  return root_below(bound.lower()) - root_above((bound + Ball(most)).upper());
}

TaskReaches::FromLink TaskReaches::FromLink::shifted(double by) const {
  return {enclosure::shifted(across, by), enclosure::shifted(begin, by), enclosure::shifted(end, by),
          enclosure::shifted(along, by)};
}

TaskReaches::TaskReaches(const Parameters& robot, const TaskOfMotion& task, std::size_t order,
                         const std::function<double(const TaskRow&)>& may_miss) {
  if (task.empty()) return;
  segments_.resize(task.rows.size());
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    for (const TaskRow& row : task.rows[s]) add(robot, row, may_miss(row), segments_[s]);
    segments_[s].series.emplace(segments_[s].recording, order);
  }
}

void TaskReaches::add(const Parameters& robot, const TaskRow& row, double may_miss, Segment& to) const {
  const std::size_t output = to.recording.outputs().size();
  const auto at = Posture<Active>::of(robot, {to.recording.input(0), to.recording.input(1)});
  const Point<Active> point{row.vector[0], row.vector[1]};
  Side::Of of = Side::Of::kValue;
  double length = 0;
  switch (row.kind) {
    case TaskRow::Kind::kTip:
      to.recording.output(dot(point, at.tip) - row.number);
      break;
    case TaskRow::Kind::kElbow:
      to.recording.output(dot(point, at.elbow) - row.number);
      break;
    case TaskRow::Kind::kAngles:
      to.recording.output(dot(point, {at.q[0], at.q[1]}) - row.number);
      break;
    case TaskRow::Kind::kTipRadius: {
      const Point<Active> from = minus(at.tip, point);
      to.recording.output(dot(from, from));
      of = Side::Of::kSquare;
      break;
    }
    case TaskRow::Kind::kClearance1:
    case TaskRow::Kind::kClearance2: {
      const bool first = row.kind == TaskRow::Kind::kClearance1;
      const Point<Active> begin = first ? Point<Active>{0.0, 0.0} : at.elbow, end = first ? at.elbow : at.tip;
      length = robot.link.length[first ? 0 : 1];
      const Active scale = enclosure::constant(Ball(1) / Ball(length));
      const Point<Active> from = minus(point, begin), beyond = minus(point, end), way = minus(end, begin),
                          along{scale * way.x, scale * way.y};
      const Active across = along.x * from.y - along.y * from.x;
      for (const Active& value : {across * across, dot(from, from), dot(beyond, beyond), dot(along, from)}) {
        to.recording.output(value);
      }
      of = Side::Of::kSquareToLink;
    }
  }
  if (row.lower > -task::kNone) to.sides.push_back(Side::make(row, of, true, output, length, may_miss));
  if (row.upper == task::kNone) return;
  // A point is never nearer to a link than to the line through it, but may well be farther.
  if (of == Side::Of::kSquareToLink) throw std::logic_error("TaskReaches: distances from links are bounded from below");
  to.sides.push_back(Side::make(row, of, false, output, length, may_miss));
}

bool TaskReaches::include(const AlongLinks& motion, const Ball& length, double time, std::size_t segment) {
  if (segments_.empty()) return true;
  Segment& s = segments_[segment];
  for (std::size_t j = 0; j < kJoints; ++j) s.series->set(j, motion.near[j], motion.over[j]);
  const std::vector<Polynomial>& values = s.series->values();
  for (Side& side : s.sides) {
    if (include(side, values, length, time)) continue;
    const TaskRow& row = side.row;
    gap_ = {fmt::format("{}{} may be missed by {:.9g} {}, allowed {:.3g}", row.name,
                        row.link == 0 ? "" : fmt::format(" (link {})", row.link), -side.clearance(), row.unit(),
                        side.may_miss),
            side.shortfall.time()};
    return false;
  }
  return true;
}

bool TaskReaches::include(Side& side, const std::vector<Polynomial>& values, const Ball& length, double time) {
  const auto output = [&](std::size_t i) -> const Polynomial& { return values[side.output + i]; };
  if (side.of != Side::Of::kSquareToLink) return side.shortfall.include(side.beyond(output(0)), length, time);
  return include(side, {output(0), output(1), output(2), output(3)}, length.upper(), time, 0);
}

// A point is as far from a link as from the line through it, or from one of its ends if it lies beyond that end. It is
// never nearer than the line, so the line's distance is used if the interval is too short to decide.
bool TaskReaches::include(Side& side, const FromLink& from, double length, double time, int depth) {
  Reach& reach = side.shortfall;
  const Ball along = over(from.along, length);
  const bool before = along.upper() <= 0, after = along.lower() >= side.length;
  if (before) return reach.include(side.beyond(from.begin), length, time);
  if (after) return reach.include(side.beyond(from.end), length, time);
  const Polynomial to_line = side.beyond(from.across);
  const double past = std::max({0.0, -along.lower(), along.upper() - side.length});
  const bool is_line = past * past <= std::max(0.0, kResolvedEnd * reach.allowed());
  if (is_line || depth >= kMostLinkHalvings || !along.is_bounded() || reach.is_below(to_line, length)) {
    return reach.include(to_line, length, time);
  }
  const double half = rounded_up(length / 2);
  return include(side, from, half, time, depth + 1) && include(side, from.shifted(half), half, time + half, depth + 1);
}

std::vector<TaskReaches::Clearance> TaskReaches::clearances() const {
  std::vector<Clearance> all;
  for (const Segment& segment : segments_) {
    for (const Side& side : segment.sides) {
      const TaskRow& row = side.row;
      auto known = std::find_if(all.begin(), all.end(),
                                [&](const Clearance& c) { return c.name == row.name && c.link == row.link; });
      if (known == all.end()) {
        known = all.insert(all.end(), {row.name, row.link, row.unit(), HUGE_VAL, 0});
      }
      if (side.clearance() >= known->clearance) continue;
      known->clearance = side.clearance();
      known->time = side.shortfall.time();
    }
  }
  return all;
}

}  // namespace fjr
