// All slots for solving: processes on this machine and, while this instance owns its robot, workers on other machines.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "planner/service/remote_solvers.h"
#include "planner/service/solvers.h"

namespace fjr {

class Slots {
 public:
  // The arguments are those of Solvers.
  Slots(std::size_t here, WorkerSettings settings, std::function<void()> wake, std::shared_ptr<Turns> turns)
      : here_(here, std::move(settings), std::move(wake), std::move(turns)) {}

  // Lets workers on other machines get leases, until disown().
  void own(const dds::Participant& participant, dds::Waitset& waitset, RemoteSolvers::Owner owner, std::uint64_t epoch);
  // Cancels all leases. Their jobs must have been stopped or handed over before.
  void disown();

  bool may_solve_here() { return here_.may_solve(); }
  bool may_solve() { return here_.may_solve() || (owner_ && elsewhere_->load()); }
  void withdraw() { here_.withdraw(); }
  std::optional<Job> solve(Job job);  // at the least busy place; returns the job if it cannot be sent
  void replace_missing() { here_.replace_missing(); }
  Solvers::News take_news();

  // Stops solving the first job for which which(job) is true, and returns it.
  template <class Which>
  std::optional<Job> stop_if(Which&& which) {
    if (auto job = here_.stop_if(which)) return job;
    return elsewhere_ ? elsewhere_->stop_if(which) : std::nullopt;
  }

  std::vector<const Job*> jobs() const;  // being solved
  std::size_t size() const { return here_.size() + (owner_ ? elsewhere_->size() : 0); }
  std::uint64_t lost() const { return here_.lost() + (elsewhere_ ? elsewhere_->lost() : 0); }
  std::uint64_t memory() const { return here_.memory(); }  // [bytes] resident, on this machine

 private:
  Solvers here_;
  std::optional<RemoteSolvers> elsewhere_;  // once this instance has owned its robot
  bool owner_ = false;
};

}  // namespace fjr
