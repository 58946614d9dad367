// What all solves of one request share: what they may take, who stops them, who is told, and the account of what was
// done. It is passed by reference to whatever solves.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "planner/problem/quantities.h"
#include "planner/search/account.h"
#include "planner/search/settings.h"

namespace fjr {

struct SessionOptions {
  ContinuationSettings settings{};
  double deadline = 0;              // [s] of wall time; 0: none
  double most_work = kNoLimit;      // [s] of work (SolveReport::work) in all phases together
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
  bool stopped() const { return stopped_; }
  bool deadline_passed() const { return deadline_passed_; }

  // From here, work may come to what this phase and those before it are allowed together. Nothing is at first.
  void enter(Phase phase);

  // Of the solve at work: its own iterations, and its objective as it is optimised.
  void tell(Progress progress) const;

  // A solve has ended.
  void add(SolverStage stage);

  const Account& account() const { return account_; }
  Fallbacks& fallbacks() { return account_.fallbacks; }

 private:
  friend class Timed;
  using Clock = std::chrono::steady_clock;

  SessionOptions options_;
  Account account_;
  const Clock::time_point began_ = Clock::now();
  double work_ = 0, allowed_ = 0;  // [s] done, with that of the solve at work; allowed in the present phase
  Phase phase_ = Phase::kFinding;  // the latest that was entered
  bool stopped_ = false, deadline_passed_ = false;
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
  void pause();

  Session& session_;
  std::string part_;
  Timed* const around_;
  Session::Clock::time_point since_ = Session::Clock::now();
};

}  // namespace fjr
