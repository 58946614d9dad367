// The stop motions of a plan, checked by whoever has to rely on them: in a thread of their own that runs ahead of the
// motion, about ten times as fast.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "planner/stop/stop_motion.h"

namespace fjr {

class CheckedStops {
 public:
  // All can be used.
  explicit CheckedStops(std::vector<Trajectory> stops);
  // Begins to check them; `plan` is where they leave from.
  CheckedStops(const Parameters& robot, Trajectory plan, std::vector<StopMotion> stops);

  // For the tick, which neither waits nor allocates.
  std::size_t size() const { return rows_.size(); }
  std::size_t usable() const { return usable_.load(std::memory_order_acquire); }  // so many, from the first on
  const Trajectory& at(std::size_t i) const { return rows_[i]; }                  // a usable one; empty: see StopMotion

  bool over() const { return over_.load(std::memory_order_acquire); }  // all are checked, or one cannot be used
  const std::string& fault() const { return fault_; }                  // once it is over: that one, or empty

  void give_up();  // and waits until it is over

 private:
  void check(const Parameters& robot, const Trajectory& plan, const std::vector<StopMotion>& stops,
             const std::stop_token& unwanted);

  std::vector<Trajectory> rows_;
  std::atomic<std::size_t> usable_ = 0;
  std::atomic<bool> over_ = false;
  std::string fault_;
  std::jthread checking_;  // last: it ends before what it writes to
};

}  // namespace fjr
