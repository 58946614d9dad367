// Rigorous lower bounds on the clearance of a motion from the task's constraints at all times.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planner/certificate/proof/reach.h"
#include "planner/certificate/proof/series_along.h"
#include "planner/certificate/task_of_motion.h"
#include "planner/problem/task/task.h"

namespace fjr {

// The links' angles over a time, as SeriesAlong::set() takes them.
struct AlongLinks {
  Joints<enclosure::Polynomial> near, over;
};

class TaskReaches {
 public:
  // may_miss: by how much a row may be missed, >= 0. [m or rad] order: of the polynomials, the last
  // coefficient of which holds the remainder.
  TaskReaches(const Parameters& robot, const TaskOfMotion& task, std::size_t order,
              const std::function<double(const TaskRow&)>& may_miss);
  TaskReaches(const TaskReaches&) = delete;
  TaskReaches& operator=(const TaskReaches&) = delete;

  // Includes [0, length] of a motion, which begins at `time` [s] and lies in one segment. Returns false if a row may be
  // missed by more than is allowed; gap() then says which.
  bool include(const AlongLinks& motion, const enclosure::Ball& length, double time, std::size_t segment);

  struct Gap {
    std::string reason;
    double time = 0;  // [s]
  };
  const Gap& gap() const { return gap_; }

  // Least clearance of the rows of one name and link; negative: how far they may be missed. [m or rad]
  struct Clearance {
    std::string name;
    int link;  // 1 or 2; 0: neither
    std::string unit;
    double clearance;
    double time;  // [s] where
  };
  std::vector<Clearance> clearances() const;

 private:
  // One bound of a row. shortfall: by how much its value, or for distances its square, is beyond the bound.
  struct Side {
    enum class Of { kValue, kSquare, kSquareToLink };
    TaskRow row;
    Of of;
    bool is_lower;
    std::size_t output;  // the first of those of its row
    double length;       // [m] of the link, of kSquareToLink
    enclosure::Ball bound;
    double may_miss;
    Reach shortfall;

    static Side make(const TaskRow& row, Of of, bool is_lower, std::size_t output, double length, double may_miss);
    // Returns by how much a value, or its square, is beyond the bound.
    enclosure::Polynomial beyond(enclosure::Polynomial value) const;
    double clearance() const;
  };
  // The distance of a point from a link over a time: squared from the line through it and from its ends, and how far
  // along the line it is.
  struct FromLink {
    enclosure::Polynomial across, begin, end, along;

    FromLink shifted(double by) const;
  };
  struct Segment {
    enclosure::Recording recording{kJoints};
    std::vector<Side> sides;
    std::optional<SeriesAlong> series;  // made when the recording is complete
  };

  void add(const Parameters& robot, const TaskRow& row, double may_miss, Segment& to) const;
  bool include(Side& side, const std::vector<enclosure::Polynomial>& values, const enclosure::Ball& length,
               double time);
  bool include(Side& side, const FromLink& from, double length, double time, int depth);

  std::vector<Segment> segments_;
  Gap gap_;
};

}  // namespace fjr
