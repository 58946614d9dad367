// The last runs that executors have published, from which the next repetition of their motions learns. The number is
// bounded; the oldest are dropped first.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <memory>
#include <utility>

#include "planner/protocol/execution_messages.h"

namespace fjr {

using SharedRun = std::shared_ptr<const ExecutedRun>;

class ExecutedRuns {
 public:
  // Adds a run. Runs that cannot be the log of a motion are ignored. A trajectory runs only once, so the first report
  // of a run counts.
  void add(ExecutedRun run) {
    if (!could_be(run) || contains(run.trajectory_id)) return;
    bytes_ += size_of(run);
    runs_.push_back(std::make_shared<const ExecutedRun>(std::move(run)));
    while (runs_.size() > 1 && (runs_.size() > kMost || bytes_ > kMostBytes)) {
      bytes_ -= size_of(*runs_.front());
      runs_.pop_front();
    }
  }

  bool contains(const RequestId& trajectory_id) const {
    return last([&](const RequestId& id) { return id == trajectory_id; }) != nullptr;
  }

  // Returns the last run whose trajectory id satisfies which(id), or null.
  template <class Which>
  SharedRun last(Which&& which) const {
    const auto found =
        std::find_if(runs_.rbegin(), runs_.rend(), [&](const SharedRun& run) { return which(run->trajectory_id); });
    return found == runs_.rend() ? nullptr : *found;
  }

 private:
  static constexpr std::size_t kMost = 64, kMostBytes = 64 << 20;

  static std::size_t size_of(const ExecutedRun& run) { return sizeof run + run.rows.size() * sizeof(ExecutedRow); }

  static bool could_be(const ExecutedRun& run) {
    const auto both = [](const Joints<double>& v) { return std::isfinite(v[0]) && std::isfinite(v[1]); };
    for (std::size_t i = 0; i < run.rows.size(); ++i) {
      const ExecutedRow& r = run.rows[i];
      if (!std::isfinite(r.time) || (i > 0 && r.time <= run.rows[i - 1].time)) return false;
      if (!both(r.q) || !both(r.theta) || !both(r.torque) || !both(r.planned_q) || !both(r.planned_theta)) return false;
    }
    return run.rows.size() >= 2;
  }

  std::size_t bytes_ = 0;
  std::deque<SharedRun> runs_;  // of arrival
};

}  // namespace fjr
