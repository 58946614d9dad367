// The owner's table of leases: which worker on another machine solves which job, and until when. The caller provides
// the time and the communication over DDS.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "planner/protocol/work_messages.h"
#include "planner/service/job_queue.h"

namespace fjr {

// Ten heartbeats of a worker. Even if one packet in twenty is lost, ten in a row practically never are.
inline constexpr std::chrono::milliseconds kLeaseTime{1500};

class LeaseTable {
 public:
  using Clock = Job::Clock;

  struct Leased {
    WorkerId worker{};
    Job job;
    Clock::time_point extended;
  };

  // owner: id of this process.
  explicit LeaseTable(const std::array<std::uint8_t, 16>& owner) : owner_(owner) {}

  void own(std::uint64_t epoch) { epoch_ = epoch; }

  // Extends the leases that the offer names. Returns those of them whose result is no longer needed: leases of this
  // owner that are not in the table any more, and leases of other owners with an earlier or the same epoch.
  std::vector<LeaseId> heard(const WorkerOffer& offer, Clock::time_point now) {
    Machine& machine = machines_[offer.worker];
    machine = {.slots = offer.slots, .heard = now};
    std::vector<LeaseId> over;
    for (const HeldLease& held : offer.held) {
      const auto leased = held.lease.owner == owner_ ? leases_.find(held.lease.number) : leases_.end();
      if (leased != leases_.end() && leased->second.worker == offer.worker) {
        leased->second.extended = now;
      } else if (held.lease.owner == owner_ || held.lease.epoch <= epoch_) {
        over.push_back(held.lease);
      } else {
        ++machine.others;
      }
    }
    return over;
  }

  // Marks the worker as full until its next offer.
  void full(const WorkerId& worker) {
    const auto machine = machines_.find(worker);
    if (machine != machines_.end()) machine->second.full = true;
  }

  // Removes a worker that is gone. Returns the jobs it had.
  std::vector<Job> lost(const WorkerId& worker) {
    machines_.erase(worker);
    return take_jobs([&](const Leased& leased) { return leased.worker == worker; });
  }

  // Returns the workers that were not heard for the time of a lease.
  std::vector<WorkerId> silent(Clock::time_point now) const {
    std::vector<WorkerId> workers;
    for (const auto& [worker, machine] : machines_) {
      if (now - machine.heard > kLeaseTime) workers.push_back(worker);
    }
    return workers;
  }
  // Removes leases that were not extended for the time of a lease. Returns their jobs.
  std::vector<Job> expired(Clock::time_point now) {
    return take_jobs([&](const Leased& leased) { return now - leased.extended > kLeaseTime; });
  }

  // The worker with the smallest fraction (0 to 1) of occupied slots among those for which may(worker) is true.
  struct Choice {
    WorkerId worker{};
    double load = 0;
  };
  template <class May>
  std::optional<Choice> least_loaded(May&& may) const {
    std::optional<Choice> least;
    for (const auto& [worker, machine] : machines_) {
      const std::size_t taken = machine.others + of(worker);
      if (machine.full || taken >= machine.slots || !may(worker)) continue;
      const double load = static_cast<double>(taken) / static_cast<double>(machine.slots);
      if (!least || load < least->load) least = {worker, load};
    }
    return least;
  }

  LeaseId grant(const WorkerId& worker, Job job, Clock::time_point now) {
    leases_[++last_] = {worker, std::move(job), now};
    return id_of(last_);
  }

  // Removes a lease and returns its job.
  std::optional<Job> take(const LeaseId& lease, const WorkerId& worker) {
    const Leased* leased = find(lease, worker);
    if (leased == nullptr) return std::nullopt;
    Job job = std::move(leases_.at(lease.number).job);
    leases_.erase(lease.number);
    return job;
  }
  const Leased* find(const LeaseId& lease, const WorkerId& worker) const {
    const auto leased = lease.owner == owner_ ? leases_.find(lease.number) : leases_.end();
    return leased != leases_.end() && leased->second.worker == worker ? &leased->second : nullptr;
  }

  // Removes the first lease whose job satisfies which(job).
  struct Stopped {
    LeaseId lease;
    WorkerId worker{};
    Job job;
  };
  template <class Which>
  std::optional<Stopped> stop_if(Which&& which) {
    const auto found = std::find_if(leases_.begin(), leases_.end(), [&](const auto& l) { return which(l.second.job); });
    if (found == leases_.end()) return std::nullopt;
    Stopped stopped{id_of(found->first), found->second.worker, std::move(found->second.job)};
    leases_.erase(found);
    return stopped;
  }

  std::vector<const Job*> jobs() const {
    std::vector<const Job*> jobs;
    for (const auto& [number, leased] : leases_) jobs.push_back(&leased.job);
    return jobs;
  }
  std::size_t slots() const {
    std::size_t all = 0;
    for (const auto& [worker, machine] : machines_) all += machine.slots;
    return all;
  }

 private:
  struct Machine {
    std::size_t slots = 0, others = 0;  // others: taken by leases of others
    Clock::time_point heard;
    bool full = false;
  };

  LeaseId id_of(std::uint64_t number) const { return {owner_, epoch_, number}; }
  std::size_t of(const WorkerId& worker) const {
    return static_cast<std::size_t>(
        std::count_if(leases_.begin(), leases_.end(), [&](const auto& l) { return l.second.worker == worker; }));
  }
  template <class Which>
  std::vector<Job> take_jobs(Which&& which) {
    std::vector<Job> jobs;
    std::erase_if(leases_, [&](auto& lease) {
      if (!which(lease.second)) return false;
      jobs.push_back(std::move(lease.second.job));
      return true;
    });
    return jobs;
  }

  const std::array<std::uint8_t, 16> owner_;
  std::uint64_t epoch_ = 0, last_ = 0;
  std::map<std::uint64_t, Leased> leases_;
  std::map<WorkerId, Machine> machines_;
};

}  // namespace fjr
