#include "planner/service/companions.h"

#include <algorithm>

#include "planner/service/watchdog.h"

namespace fjr {

Companions::Companions(const ServiceConfig& config, std::size_t count)
    : turns_(count > 1 ? std::make_shared<Turns>(config.workers) : nullptr),
      ready_(count),
      alive_(count),
      latest_(count) {
  if (config.metrics_port) metrics_.emplace(*config.metrics_port);
}

bool Companions::last_of_all(std::vector<bool>& told, std::size_t which) {
  told[which] = true;
  return std::ranges::all_of(told, [](bool one) { return one; });
}

void Companions::ready(std::size_t which) {
  const std::lock_guard lock(mutex_);
  if (last_of_all(ready_, which)) tell_ready();
}

// The watchdog hears of them only when all are alive, so that one that hangs is noticed.
void Companions::alive(std::size_t which) {
  const std::lock_guard lock(mutex_);
  if (!last_of_all(alive_, which)) return;
  alive_.assign(alive_.size(), false);
  tell_alive();
}

void Companions::publish(std::size_t which, Metrics metrics) {
  const std::lock_guard lock(mutex_);
  latest_[which] = std::move(metrics);
  metrics_->publish(metrics_text(latest_));
}

}  // namespace fjr
