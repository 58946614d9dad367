// Runs one host per robot in service.yaml within one process. Each has its own thread, DDS participant and instance
// name, so that owners and standbys, epochs, queues and executors of the robots are independent of each other.
#pragma once

#include <cstddef>
#include <exception>
#include <memory>
#include <thread>
#include <vector>

#include "planner/service/companions.h"
#include "planner/service/service_config.h"

namespace fjr {

// Host: Service or WorkerHost.
template <class Host>
class OnePerRobot {
 public:
  explicit OnePerRobot(const ServiceConfig& config) {
    const std::vector<ServiceConfig> all = one_per_robot(config);
    const auto companions = std::make_shared<Companions>(config, all.size());
    for (const ServiceConfig& one : all) {
      hosts_.push_back(std::make_unique<Host>(one, Companion(companions, hosts_.size())));
    }
  }

  // Runs all hosts until stop(), the first one in this thread. If one fails, all end, and its exception is thrown.
  void run() {
    std::vector<std::exception_ptr> problems(hosts_.size());
    {
      std::vector<std::jthread> threads;
      try {
        for (std::size_t i = 1; i < hosts_.size(); ++i) {
          threads.emplace_back([this, i, &problem = problems[i]] { run(*hosts_[i], problem); });
        }
      } catch (...) {  // out of threads: those that run would never end
        stop();
        throw;
      }
      run(*hosts_.front(), problems.front());
    }
    for (const std::exception_ptr& problem : problems) {
      if (problem) std::rethrow_exception(problem);
    }
  }
  void stop() {  // from any thread
    for (const auto& host : hosts_) host->stop();
  }

 private:
  void run(Host& host, std::exception_ptr& problem) {
    try {
      host.run();
    } catch (...) {
      problem = std::current_exception();
      stop();
    }
  }

  std::vector<std::unique_ptr<Host>> hosts_;
};

}  // namespace fjr
