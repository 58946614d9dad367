// The task of a request, arranged along a motion.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "planner/problem/task/task.h"

namespace fjr {

// The rows of the task in each segment of the motion, as many in each, and when the segments end [s].
struct TaskOfMotion {
  std::vector<std::vector<TaskRow>> rows;
  std::vector<double> ends;

  static TaskOfMotion of(const Parameters& robot, const Task& task, std::vector<double> ends) {
    TaskOfMotion t{{}, std::move(ends)};
    for (std::size_t s = 0; s < t.ends.size(); ++s) t.rows.push_back(task_rows(robot, task, s));
    return t;
  }

  bool empty() const { return rows.empty() || rows.front().empty(); }
  // Returns the segment at a time [s]; an end belongs to the segment that it ends.
  std::size_t segment_at(double time) const {
    const auto end = std::lower_bound(ends.begin(), ends.end(), time);
    return std::min(static_cast<std::size_t>(end - ends.begin()), ends.empty() ? 0 : ends.size() - 1);
  }
};

}  // namespace fjr
