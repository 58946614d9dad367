// Workers on other machines that solve for the owner of a robot. Requests are leased to them and come back with a
// result, or without one when the lease expires.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planner/dds/lease_port.h"
#include "planner/protocol/log_limit.h"
#include "planner/service/lease_table.h"
#include "planner/service/solvers.h"

namespace fjr {

class RemoteSolvers {
 public:
  struct Owner {
    std::string instance, robot_id, robot_hash;
  };

  // Incoming messages wake up `waitset`.
  RemoteSolvers(const dds::Participant& participant, dds::Waitset& waitset, Owner owner);

  void own(std::uint64_t epoch) { leases_.own(epoch); }

  // Returns the occupied fraction of slots of the least busy worker; nothing if no slot is free.
  std::optional<double> load() const;
  std::optional<Job> solve(Job job);  // returns the job if it cannot be sent to any worker

  Solvers::News take_news();
  void drop_news();  // discards messages while this instance is not the owner

  template <class Which>
  std::optional<Job> stop_if(Which&& which) {
    auto stopped = leases_.stop_if(which);
    if (!stopped) return std::nullopt;
    end(stopped->worker, stopped->lease);
    return std::move(stopped->job);
  }

  std::vector<const Job*> jobs() const { return leases_.jobs(); }
  std::size_t size() const { return leases_.slots(); }
  std::uint64_t lost() const { return lost_; }  // solving processes that ended unexpectedly
  void flush(std::chrono::nanoseconds timeout) const { port_.flush(timeout); }

 private:
  std::optional<LeaseTable::Choice> choice() const;
  LeaseWord word(const LeaseId& lease, LeaseKind kind) const;
  void end(const WorkerId& worker, const LeaseId& lease);
  void hear(const WorkerOffer& offer, Solvers::News& news);
  void report_progress(const WorkerOffer& offer, Solvers::News& news) const;
  void lose(const WorkerId& worker, const char* why, Solvers::News& news);
  void refuse(const WorkerOffer& offer, RefusedFor what, const std::string& sentence);
  void take(WorkResult result, Solvers::News& news);

  const Owner owner_;
  dds::LeasePort port_;
  LeaseTable leases_;
  std::map<WorkerId, std::string> names_;  // of those who are given leases
  std::uint64_t lost_ = 0;
  LogLimit log_refused_;
};

}  // namespace fjr
