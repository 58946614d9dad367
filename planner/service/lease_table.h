// Who solves what on other machines, and until when, as the owner knows it. Time and DDS are the caller's.
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

// Ten heartbeats of a worker: with one packet in twenty lost that many are never lost in a row.
inline constexpr std::chrono::milliseconds kLeaseTime{1500};

class LeaseTable {
 public:
  using Clock = Job::Clock;

  struct Leased {
    WorkerId worker{};
    Job job;
    Clock::time_point extended;
  };

  // owner: of this process.
  explicit LeaseTable(const std::array<std::uint8_t, 16>& owner) : owner_(owner) {}

  void own(std::uint64_t epoch) { epoch_ = epoch; }

  // Extends the leases that the offer names. Returns those of them that nobody waits for: of this owner when they are
  // in the book no more, of others when this owner came after them.
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

  // The worker takes nothing before its next offer.
  void full(const WorkerId& worker) {
    const auto machine = machines_.find(worker);
    if (machine != machines_.end()) machine->second.full = true;
  }

  // The worker is gone: the jobs it had.
  std::vector<Job> lost(const WorkerId& worker) {
    machines_.erase(worker);
    return take_jobs([&](const Leased& leased) { return leased.worker == worker; });
  }

  // Workers that were not heard for a lease's time.
  std::vector<WorkerId> silent(Clock::time_point now) const {
    std::vector<WorkerId> workers;
    for (const auto& [worker, machine] : machines_) {
      if (now - machine.heard > kLeaseTime) workers.push_back(worker);
    }
    return workers;
  }
  // Jobs of leases that were not extended for so long.
  std::vector<Job> expired(Clock::time_point now) {
    return take_jobs([&](const Leased& leased) { return now - leased.extended > kLeaseTime; });
  }

  // The share of its slots that is taken, 0 to 1, of the worker where that is least and `may` holds of it.
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

  // What a lease was for, once: afterwards the lease is forgotten.
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

  // The same for the first job of which `which` holds.
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
