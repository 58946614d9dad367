// The jobs that wait to be solved, ordered by priority. Within a priority the participants take turns, and the jobs of
// one participant are ordered by arrival. The number per participant is bounded.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "planner/protocol/messages.h"
#include "planner/request/request.h"
#include "planner/service/executed_runs.h"

namespace fjr {

struct Job {
  using Clock = std::chrono::steady_clock;

  Order order;
  Request request;       // the motion to be planned, with its start filled in
  std::string document;  // the same, as solving processes read it
  std::string request_hash;
  std::string robot_hash;  // of the robot it is planned for: the served one, possibly with the request's payload
  bool rest_to_rest = false;
  Clock::time_point arrived, deadline, started;
  int lost = 0;                              // number of workers that died while solving it
  SharedReply planned = nullptr;             // a plan to be executed, which only needs stop motions
  SharedRun run = nullptr;                   // if set: last run of `planned`, by which it is corrected first
  std::optional<double> refused_fraction{};  // fraction of this correction that the executor refused
  std::chrono::steady_clock::time_point awaited_since{};
  std::optional<RequestId> awaited{};  // a trajectory whose run has yet to arrive, before `planned` and `run` are known
};

// Returns whether a job must be solved on this machine, because runs are not sent to others.
inline bool solved_here(const Job& job) { return job.order.action == Action::kRepeat; }

class JobQueue {
 public:
  // capacity: of one participant.
  explicit JobQueue(std::size_t capacity) : capacity_(capacity) {}

  // Returns whether a participant has no room for another job. If many participants have many jobs, each gets an equal
  // fraction of the total, so that new participants still get in.
  bool full_for(const Origin& origin) const {
    const std::size_t most = kClients * capacity_;
    if (jobs_.size() < most) return of(origin) >= capacity_;
    std::set<Origin> participants{origin};
    for (const Job& job : jobs_) participants.insert(job.order.origin);
    return of(origin) >= std::clamp<std::size_t>(most / participants.size(), 1, capacity_);
  }
  // Returns the number of jobs of a participant.
  std::size_t of(const Origin& origin) const {
    return static_cast<std::size_t>(
        std::count_if(jobs_.begin(), jobs_.end(), [&](const Job& job) { return job.order.origin == origin; }));
  }
  bool empty() const { return jobs_.empty(); }
  std::size_t size() const { return jobs_.size(); }
  std::size_t capacity() const { return capacity_; }

  void push(Job job) { jobs_.push_back(std::move(job)); }
  void push_front(Job job) { jobs_.push_front(std::move(job)); }  // puts back a job that already had its turn

  template <class Ready>
  bool any_of(Ready&& ready) const {
    return std::any_of(jobs_.begin(), jobs_.end(), ready);
  }

  // Removes and returns the next job for which ready(job) is true.
  template <class Ready>
  std::optional<Job> pop_if(Ready&& ready) {
    auto next = jobs_.end();
    for (auto job = jobs_.begin(); job != jobs_.end(); ++job) {
      if (ready(*job) && (next == jobs_.end() || before(*job, *next))) next = job;
    }
    if (next == jobs_.end()) return std::nullopt;
    Job job = std::move(*next);
    jobs_.erase(next);
    last_turn_[job.order.origin] = ++turns_;
    std::erase_if(last_turn_, [&](const auto& turn) { return of(turn.first) == 0; });
    return job;
  }
  Job pop() {
    return *pop_if([](const Job&) { return true; });
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
  static constexpr std::size_t kClients = 8;  // number of participants that may use their full capacity

  std::uint64_t last_turn(const Job& job) const {
    const auto found = last_turn_.find(job.order.origin);
    return found == last_turn_.end() ? 0 : found->second;
  }
  bool before(const Job& a, const Job& b) const {
    if (a.order.priority != b.order.priority) return a.order.priority > b.order.priority;
    return last_turn(a) < last_turn(b);
  }

  std::size_t capacity_;
  std::deque<Job> jobs_;                       // of arrival
  std::map<Origin, std::uint64_t> last_turn_;  // of those who wait
  std::uint64_t turns_ = 0;
};

}  // namespace fjr
