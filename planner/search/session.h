// What all solves of one request share: the limits on their work and time, cancellation, progress reports, and the
// account of what was done.
#pragma once

#include <algorithm>
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
#include "planner/collocation/scheme.h"
#include "planner/problem/quantities.h"
#include "planner/search/account.h"
#include "planner/search/settings.h"

namespace fjr {

struct SessionOptions {
  SearchSettings search{};
  Scheme scheme = hermite_simpson();
  std::string linear_solver = "stage";
  double deadline = 0;              // [s] of wall time; 0: none
  double most_work = kNoLimit;      // [s] of work (SolveReport::work) in all phases but fallbacks and damping
  double budget_factor = 1;         // most_work as a multiple of the usual one
  int jobs = 1;                     // threads at most
  double objective_scale = 1;       // factor from an optimised objective to the requested one
  std::function<bool()> cancelled;  // polled between iterations; may be empty
  std::function<void(const Progress&)> on_progress;  // may be empty
};

// What becomes of a piece of work that was done beside others. Results that are ignored must not be used, so that the
// outcome is the same for any number of threads.
enum class PieceOfWork {
  kCounts,
  kIgnored,  // what was allowed had been used up by those before it
};

class Session {
 public:
  explicit Session(SessionOptions options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const SessionOptions& options() const { return options_; }
  const SearchSettings& settings() const { return options_.search; }

  // Returns whether to stop: because everything is stopped, or the work of the phase is used up. This is called before
  // every solve and in every iteration, with the work [s] since the last call.
  bool interrupted(double work = 0);

  // Returns whether everything is to stop: cancelled, or the deadline passed.
  bool stopped() const { return shared_->stopped; }
  bool deadline_passed() const { return shared_->deadline_passed; }

  // Returns the work [s] that may be done in all: more than the options say for fallbacks, and from the phase of
  // damping on.
  double most_work() const { return std::max(options_.most_work, allowed_); }

  // Enters a phase: from now on, work may add up to what this phase and those before it may use together. Before the
  // first call no work is allowed.
  void enter(Phase phase);

  // Allows this phase and all later ones a fraction of the options' work in addition.
  void allow_more(double fraction);

  // Sets the number of finished and of planned starts, for progress reports.
  void tell_starts(int done, int planned);

  // Reports progress of the present solve. progress: its own iterations and scaled objective; the rest is filled in.
  void tell(Progress progress) const;

  // Adds a finished solve to the account.
  void add(SolverStage stage);

  // Does `count` independent pieces of work, as many at a time as threads are idle. Each has a session of its own,
  // which is stopped with this one and may do half of the work that this one still may; a single piece has this
  // session. Their work is counted in the order of their indices, until what is allowed is used up. If pieces throw,
  // the exception of one of them is thrown again when all have ended.
  std::vector<PieceOfWork> do_all(std::size_t count, const std::function<void(std::size_t, Session&)>& task);

  // Does the same while this session works itself; its own work is counted first, and may take all that is left.
  std::vector<PieceOfWork> do_beside(const std::function<void()>& own, std::size_t count,
                                     const std::function<void(std::size_t, Session&)>& task);

  // Does pieces of work that need no session, on the same threads.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& task);
  // Returns for_each() as a function to pass on. The session must outlive it.
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

  // State that a session shares with its branches, the sessions of parallel work.
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
  PieceOfWork join(const Session& branch);
  std::vector<std::unique_ptr<Session>> branches(std::size_t count) const;
  std::function<void(std::size_t)> in_branches(const std::vector<std::unique_ptr<Session>>& branches,
                                               const std::function<void(std::size_t, Session&)>& task) const;
  std::vector<PieceOfWork> join_all(const std::vector<std::unique_ptr<Session>>& branches);
  void find_out_whether_stopped();

  SessionOptions options_;
  Account account_;
  std::shared_ptr<Shared> shared_;
  double work_ = 0, allowed_ = 0;  // [s] done, with that of the solve at work; allowed in the present phase
  double more_ = 0;                // fraction of the options' work that is allowed in addition to a phase's own
  double work_before_ = 0;         // [s] of work_ when this branch began, with half of what was left counted as done
  int iterations_before_ = 0;      // done before this branch began
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
