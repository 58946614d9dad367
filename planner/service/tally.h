// Counts of requests by their outcome, and latencies.
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "planner/protocol/messages.h"
#include "planner/service/histogram.h"

namespace fjr {

class Tally {
 public:
  using Outcome = std::pair<ReplyState, Reason>;

  void count(const Reply& reply, double latency) {
    if (!reply.final()) return;
    ++outcomes_[{reply.state, reply.why.reason}];
    if (reply.state != ReplyState::kRejected) waiting_.add(reply.wait_time);
    if (reply.solve_time > 0) solving_.add(reply.solve_time);
    switch (reply.state) {
      case ReplyState::kAccepted:
        return;
      case ReplyState::kRejected:
        ++counts_.rejected;
        return;
      case ReplyState::kSolved:
        ++counts_.solved;
        remember(latency);
        return;
      case ReplyState::kInfeasible:
        ++counts_.infeasible;
        return;
      case ReplyState::kFailed:
        ++counts_.failed;
        return;
      case ReplyState::kCancelled:
        ++counts_.cancelled;
        return;
      case ReplyState::kExpired:
        ++counts_.expired;
        return;
    }
  }
  void received() { ++counts_.received; }
  void duplicate() { ++counts_.duplicates; }

  const std::map<Outcome, std::uint64_t>& outcomes() const { return outcomes_; }
  std::uint64_t uncertified() const {
    const auto found = outcomes_.find({ReplyState::kFailed, Reason::kUncertified});
    return found == outcomes_.end() ? 0 : found->second;
  }
  const Histogram& solving() const { return solving_; }
  const Histogram& waiting() const { return waiting_; }

  // Fills in counts and latencies; the caller fills in the rest.
  ServiceStatus status() const {
    ServiceStatus status = counts_;
    std::vector<double> sorted = latencies_;
    std::sort(sorted.begin(), sorted.end());
    status.latency_p50 = quantile(sorted, 0.50);
    status.latency_p90 = quantile(sorted, 0.90);
    status.latency_p99 = quantile(sorted, 0.99);
    return status;
  }

 private:
  static constexpr std::size_t kRemembered = 512;

  void remember(double latency) {
    if (latencies_.size() < kRemembered) {
      latencies_.push_back(latency);
    } else {
      latencies_[oldest_] = latency;
      oldest_ = (oldest_ + 1) % kRemembered;
    }
  }
  static double quantile(const std::vector<double>& sorted, double fraction) {
    if (sorted.empty()) return 0;
    return sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1) + 0.5)];
  }

  ServiceStatus counts_;
  std::map<Outcome, std::uint64_t> outcomes_{
      {{ReplyState::kSolved, Reason::kNone}, 0}};  // there from the first reading
  Histogram solving_, waiting_;
  std::vector<double> latencies_;  // [s] of the last solved ones
  std::size_t oldest_ = 0;
};

}  // namespace fjr
