// Shared resources of the services of several robots in one process (one thread each): the slots for solving, the page
// of metrics, and systemd's watchdog.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "planner/service/metrics.h"
#include "planner/service/metrics_server.h"
#include "planner/service/service_config.h"
#include "planner/service/turns.h"

namespace fjr {

// May be called from any thread.
class Companions {
 public:
  Companions(const ServiceConfig& config, std::size_t count);

  std::shared_ptr<Turns> turns() const { return turns_; }  // none: there is one alone
  bool has_metrics() const { return metrics_.has_value(); }
  void publish(std::size_t which, Metrics metrics);
  void ready(std::size_t which);  // tells systemd once all are ready
  void alive(std::size_t which);

 private:
  bool last_of_all(std::vector<bool>& told, std::size_t which);

  const std::shared_ptr<Turns> turns_;
  std::mutex mutex_;  // for all below
  std::vector<bool> ready_, alive_;
  std::vector<std::optional<Metrics>> latest_;
  std::optional<MetricsServer> metrics_;
};

// What one service uses of these resources.
class Companion {
 public:
  Companion(std::shared_ptr<Companions> all, std::size_t which) : all_(std::move(all)), which_(which) {}

  std::shared_ptr<Turns> turns() const { return all_->turns(); }
  bool has_metrics() const { return all_->has_metrics(); }
  void publish(Metrics metrics) const { all_->publish(which_, std::move(metrics)); }
  void tell_ready() const { all_->ready(which_); }
  void tell_alive() const { all_->alive(which_); }

 private:
  std::shared_ptr<Companions> all_;
  std::size_t which_;
};

}  // namespace fjr
