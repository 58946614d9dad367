// The stop motions of a plan, which the executor checks itself before it relies on them. A separate thread checks them
// ahead of the motion, about ten times as fast as the motion runs.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planner/stop/stop_motion.h"

namespace fjr {

class CheckedStops {
 public:
  // Takes stops that are known to be usable.
  explicit CheckedStops(std::vector<Trajectory> stops);
  // Starts the thread that checks `stops`, which begin on `plan`.
  CheckedStops(const Parameters& robot, Trajectory plan, std::vector<StopMotion> stops);

  // These may be called from the control tick: they neither wait nor allocate.
  std::size_t size() const { return rows_.size(); }
  std::size_t usable() const { return usable_.load(std::memory_order_acquire); }  // number checked, from the first on
  const Trajectory& at(std::size_t i) const { return rows_[i]; }                  // i < usable(); empty: see StopMotion

  bool over() const { return over_.load(std::memory_order_acquire); }  // all are checked, or one cannot be used
  const std::optional<std::string>& fault() const { return fault_; }   // once over(): why one cannot be used

  void give_up();  // stops checking, and waits for the thread

 private:
  void check(const Parameters& robot, const Trajectory& plan, const std::vector<StopMotion>& stops,
             const std::stop_token& unwanted);

  std::vector<Trajectory> rows_;
  std::atomic<std::size_t> usable_ = 0;
  std::atomic<bool> over_ = false;
  std::optional<std::string> fault_;
  std::jthread checking_;  // declared last, so that it is joined before the members it writes to are destroyed
};

}  // namespace fjr
