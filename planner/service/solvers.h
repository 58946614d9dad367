// The solving processes of this machine, and their current jobs.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "planner/protocol/log_limit.h"
#include "planner/service/job_queue.h"
#include "planner/service/turns.h"
#include "planner/service/worker.h"

namespace fjr {

struct SolveOutcome {
  Job job;
  ReplyState state = ReplyState::kFailed;
  Refusal why;
  std::string plan_json;
  LinkErrors errors;              // of the rows
  std::vector<Sample> rows;       // of a certified trajectory only
  std::vector<StopMotion> stops;  // of one that is to be executed
};

class Solvers {
 public:
  // `wake` is called from other threads whenever take_news() has results or it is the turn of these solvers. turns:
  // shared with the services of other robots; null: all may solve at once.
  Solvers(std::size_t count, WorkerSettings settings, std::function<void()> wake,
          std::shared_ptr<Turns> turns = nullptr);

  bool may_solve();  // whether one is idle and it is their turn, which is then reserved until solve() or withdraw()
  void withdraw();   // there is nothing more to solve
  std::size_t free() const;         // number of idle ones, whether or not it is their turn
  std::size_t without_job() const;  // these, and those that still finish an earlier job; both can be given one soon
  double load() const;              // fraction of them that is solving, 0 to 1
  void solve(Job job);              // assigns a job to an idle one; there must be one
  void replace_missing();           // restarts those that have ended

  struct News {
    std::vector<ProgressReport> progress;
    std::vector<SolveOutcome> outcomes;
    std::vector<Job> lost;      // with their workers
    std::vector<Job> returned;  // by another machine, or because nothing is heard of it
  };
  News take_news();

  // Stops solving the first job for which which(job) is true, and returns it.
  template <class Which>
  std::optional<Job> stop_if(Which&& which) {
    for (Solver& solver : solvers_) {
      if (solver.job && which(*solver.job)) return stop(solver);
    }
    return std::nullopt;
  }

  std::vector<const Job*> jobs() const;  // being solved
  std::size_t size() const { return solvers_.size(); }
  std::uint64_t lost() const { return lost_; }  // ended unexpectedly
  std::uint64_t memory() const;                 // [bytes] resident

 private:
  struct Event {  // a worker's word
    std::uint64_t worker;
    std::optional<Frame> frame;  // none: it has ended
  };
  struct Solver {
    std::uint64_t serial = 0;
    std::unique_ptr<Worker> worker;  // none: to be started again
    int tasks = 0;                   // that were sent to it, and after which it is not idle yet
    std::optional<Job> job;
    SolveOutcome result;   // as far as it has come
    bool planned = false;  // only the stop motions are still missing

    // After its job a worker may still write what it has learnt to a disk.
    bool idle() const { return worker && !job && tasks == 0; }
  };

  void start(Solver& solver);
  void find_stops(Solver& solver);
  Job stop(Solver& solver);
  void lose(Solver& solver, News& news);
  void take_frame(Solver& solver, Frame frame, News& news);
  void report_progress(const Job& job, const std::string& payload, News& news) const;
  void conclude(Solver& solver, const std::string& payload, News& news);

  const WorkerSettings settings_;
  const std::function<void()> wake_;
  const Turn turn_;
  std::uint64_t next_serial_ = 1, lost_ = 0;
  LogLimit log_start_;
  std::mutex events_mutex_;
  std::vector<Event> events_;
  std::vector<Solver> solvers_;  // last: their threads end before what they speak to
};

}  // namespace fjr
