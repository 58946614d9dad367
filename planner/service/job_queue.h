// What waits to be solved: bounded, by priority, then by arrival.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>

#include "planner/service/messages.h"

namespace fjr {

struct Job {
  using Clock = std::chrono::steady_clock;

  Order order;
  std::string request_hash;
  std::string robot_hash;  // of the robot it is planned for: the served one, or that with the request's payload
  bool rest_to_rest = false;
  Clock::time_point arrived, deadline, started;
};

class JobQueue {
 public:
  explicit JobQueue(std::size_t capacity) : capacity_(capacity) {}

  bool full() const { return jobs_.size() >= capacity_; }
  bool empty() const { return jobs_.empty(); }
  std::size_t size() const { return jobs_.size(); }
  std::size_t capacity() const { return capacity_; }

  void push(Job job) {
    const auto behind = std::find_if(jobs_.begin(), jobs_.end(),
                                     [&](const Job& waiting) { return waiting.order.priority < job.order.priority; });
    jobs_.insert(behind, std::move(job));
  }

  Job pop() {
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    return job;
  }

  bool contains(const RequestId& id) const {
    return std::any_of(jobs_.begin(), jobs_.end(), [&](const Job& job) { return job.order.id == id; });
  }

  // Removes and returns the first job of which `which` holds.
  template <class Which>
  std::optional<Job> remove_if(Which&& which) {
    const auto found = std::find_if(jobs_.begin(), jobs_.end(), which);
    if (found == jobs_.end()) return std::nullopt;
    Job job = std::move(*found);
    jobs_.erase(found);
    return job;
  }

  const std::deque<Job>& jobs() const { return jobs_; }

 private:
  std::size_t capacity_;
  std::deque<Job> jobs_;
};

}  // namespace fjr
