// What can be solved at a time: by solving processes here and, while this instance owns its robot, on other machines.
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
  // As Solvers.
  Slots(std::size_t here, WorkerSettings settings, std::function<void()> wake, std::shared_ptr<Turns> turns)
      : here_(here, std::move(settings), std::move(wake), std::move(turns)) {}

  // From now on, until disown(), workers of other machines are given leases.
  void own(const dds::Participant& participant, dds::Waitset& waitset, RemoteSolvers::Owner owner, std::uint64_t epoch);
  // What is still leased is nobody's from now on: to be called when it has been stopped, or handed over.
  void disown();

  bool may_solve_here() { return here_.may_solve(); }
  bool may_solve() { return here_.may_solve() || (owner_ && elsewhere_->load()); }
  void withdraw() { here_.withdraw(); }
  std::optional<Job> solve(Job job);  // where the least is going on; returns it where nobody can be told of it
  void replace_missing() { here_.replace_missing(); }
  Solvers::News take_news();

  // Stops the first one that solves a job of which `which` holds, and returns the job.
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
