// What all solves of one request share: what they may take, who stops them, who is told, and the account of what was
// done. It is passed by reference to whatever solves.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "common/parallel.h"
#include "planner/problem/quantities.h"
#include "planner/search/account.h"
#include "planner/search/settings.h"

namespace fjr {

struct SessionOptions {
  ContinuationSettings settings{};
  double deadline = 0;              // [s] of wall time; 0: none
  double most_work = kNoLimit;      // [s] of work (SolveReport::work) in all phases together
  double patience = 1;              // times the usual work that most_work allows
  int jobs = 1;                     // threads at most
  double objective_scale = 1;       // what an optimised objective has to be multiplied by to be what was asked for
  std::function<bool()> cancelled;  // polled between iterations; may be empty
  std::function<void(const Progress&)> on_progress;  // may be empty
};

class Session {
 public:
  explicit Session(SessionOptions options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const SessionOptions& options() const { return options_; }

  // Whether what is being done is to end: asked before every solve and in every iteration, and told the work [s] since
  // it was asked last.
  bool interrupted(double work = 0);

  // Nothing more is to be done at all: cancelled, or the deadline passed.
  bool stopped() const { return shared_->stopped; }
  bool deadline_passed() const { return shared_->deadline_passed; }

  // From here, work may come to what this phase and those before it are allowed together. Nothing is at first.
  void enter(Phase phase);

  // How far the search has come with its starts.
  void tell_starts(int done, int planned);

  // Of the solve at work: its own iterations, and its objective as it is optimised.
  void tell(Progress progress) const;

  // A solve has ended.
  void add(SolverStage stage);

  // Does `count` independent pieces of work, as many at a time as threads are idle. Each has a session of its own,
  // which is stopped with this one and may do half of the work that this one still may; a single piece has this
  // session. Their work is counted in the order of their indices, until what is allowed is used up. Returns for each
  // piece whether it counts: what those beyond that came to is to be ignored, so that the outcome is the same for any
  // number of threads.
  std::vector<bool> do_all(std::size_t count, const std::function<void(std::size_t, Session&)>& task);

  // Does the same while this session works itself; its own work is counted first, and may take all that is left.
  std::vector<bool> do_beside(const std::function<void()>& own, std::size_t count,
                              const std::function<void(std::size_t, Session&)>& task);

  // Does pieces of work that need no session, on the same threads.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& task);
  // The same for those who are given a way to do it; the session outlives it.
  ForEach side_by_side() {
    return [this](std::size_t count, const auto& task) { for_each(count, task); };
  }

  // Does one piece of work that can do its own parts two at a time, if a thread is idle for it. Returns what it
  // returns.
  template <class Work>
  auto in_pairs(const Work& work) {
    std::optional<std::invoke_result_t<Work, const DoBoth&>> result;
    account_.cpu_of_others += shared_->threads.in_pairs([&](const DoBoth& both) { result.emplace(work(both)); });
    return *std::move(result);
  }

  const Account& account() const { return account_; }
  Fallbacks& fallbacks() { return account_.fallbacks; }

 private:
  friend class Timed;
  using Clock = std::chrono::steady_clock;

  // What a session has in common with its branches.
  struct Shared {
    explicit Shared(int jobs) : threads(jobs) {}

    Threads threads;
    std::mutex callback;  // one at a time
    std::atomic<bool> stopped = false, deadline_passed = false;
    std::atomic<int> starts = 0, starts_planned = 0;
    std::atomic<double> work = 0;  // [s] of all branches
    const Clock::time_point began = Clock::now();
  };

  struct Branch {};
  Session(Branch, const Session& trunk);
  bool join(const Session& branch);
  std::vector<std::unique_ptr<Session>> branches(std::size_t count) const;
  std::function<void(std::size_t)> in_branches(const std::vector<std::unique_ptr<Session>>& branches,
                                               const std::function<void(std::size_t, Session&)>& task) const;
  std::vector<bool> join_all(const std::vector<std::unique_ptr<Session>>& branches);
  void find_out_whether_stopped();

  SessionOptions options_;
  Account account_;
  std::shared_ptr<Shared> shared_;
  double work_ = 0, allowed_ = 0;  // [s] done, with that of the solve at work; allowed in the present phase
  double work_before_ = 0;         // [s] of work_, what was done before this branch began, or is left to others
  int iterations_before_ = 0;      // this branch began
  Phase phase_ = Phase::kFinding;  // the latest that was entered
  class Timed* innermost_ = nullptr;
};

// Adds the time for which it lives to Account::timing of a part, without the time of parts that begin within it.
class Timed {
 public:
  Timed(Session& session, std::string part);
  ~Timed();
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  friend class Session;
  void pause();
  void go_on();

  Session& session_;
  std::string part_;
  Timed* const around_;
  Session::Clock::time_point since_ = Session::Clock::now();
};

}  // namespace fjr
