#include "planner/executor/checked_stops.h"

#include <utility>

#include "planner/stop/stop_motion.h"

namespace fjr {

CheckedStops::CheckedStops(std::vector<Trajectory> stops)
    : rows_(std::move(stops)), usable_(rows_.size()), over_(true) {}

CheckedStops::CheckedStops(const Parameters& robot, Trajectory plan, std::vector<StopMotion> stops)
    : rows_(stops.size()),
      checking_([this, robot, of = std::move(plan), all = std::move(stops)](const std::stop_token& unwanted) {
        check(robot, of, all, unwanted);
      }) {}

void CheckedStops::check(const Parameters& robot, const Trajectory& plan, const std::vector<StopMotion>& stops,
                         const std::stop_token& unwanted) {
  for (std::size_t i = 0; i < stops.size() && !fault_ && !unwanted.stop_requested(); ++i) {
    try {
      rows_[i] = checked_stop(robot, plan, i, stops[i]);
      usable_.store(i + 1, std::memory_order_release);
    } catch (const std::exception& error) {
      fault_ = error.what();
    }
  }
  over_.store(true, std::memory_order_release);
}

void CheckedStops::give_up() {
  if (!checking_.joinable()) return;
  checking_.request_stop();
  checking_.join();
}

}  // namespace fjr
