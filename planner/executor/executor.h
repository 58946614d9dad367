// Runs what it receives on an arm: the control tick in a thread of its own, everything else in another.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "planner/dds/executor_port.h"
#include "planner/executor/acceptance.h"
#include "planner/executor/control.h"
#include "planner/executor/drift_watch.h"
#include "planner/executor/executor_config.h"
#include "planner/executor/history.h"
#include "planner/executor/realtime.h"
#include "planner/protocol/signature.h"
#include "planner/protocol/stamp_clock.h"

namespace fjr {

class Executor {
 public:
  Executor(const ExecutorConfig& config, const Parameters& robot, Arm& arm);

  void run();                        // until stop(); then the arm is brought to rest
  void stop() { stopping_ = true; }  // from any thread

 private:
  void keep_ticking();
  void claim();
  void look_for_others();
  void serve();
  void serve_without_orders();
  void obey();
  void take_orders();
  void consider(TrajectoryOrder order);
  bool considered(const RequestId& id) const;
  void note_considered(const RequestId& id);
  bool trusts(const TrajectoryOrder& order);
  void refuse_unsigned();
  void look_at_arm();
  std::optional<ExecutionRefusal> refusal_now(const TrajectoryOrder& order) const;
  std::optional<ExecutionRefusal> refusal_after_preparation(const TrajectoryOrder& order);
  void refuse(const RequestId& id, const ExecutionRefusal& refusal);
  void begin_to_prepare(TrajectoryOrder order);
  void conclude_preparation();
  void run(std::unique_ptr<CommandedMotion> motion);
  void publish_states();
  std::optional<RequestId> about_to_begin(const TickState& tick) const;
  void publish(const TickState& tick);
  void conclude_finished();
  void conclude(CommandedMotion& motion);
  void publish_run(const CommandedMotion& motion, const ExecutionResult& result);
  void publish_unsent_runs();
  std::string log(const CommandedMotion& motion, const ExecutionResult& result) const;
  void report_drift();
  void report_again(const History::Entry& entry);
  void come_to_rest();
  void stop_silently();
  void report_lateness() const;

  const ExecutorConfig config_;
  const Parameters robot_;
  dds::ExecutorPort port_;
  std::optional<SignatureCheck> signatures_;  // none: a domain without DDS Security
  History history_;
  const StampClock clock_;
  Control control_;
  Situation situation_;
  // A trajectory that was accepted so far, while a thread looks into it.
  struct Preparation {
    using Clock = std::chrono::steady_clock;
    TrajectoryOrder header;  // without rows and stops
    bool brings_stops = false;
    Clock::time_point began;
    std::stop_source unwanted;
    std::future<std::unique_ptr<CommandedMotion>> motion;  // last: waits for the thread
  };
  std::optional<Preparation> preparing_;
  TickState latest_;
  Claimant self_;
  std::chrono::steady_clock::time_point other_heard_{};  // an executor of the same robot
  std::optional<std::string> superseded_;                // by another executor: one sentence
  bool ticking_ = false;                                 // there is a latest one
  std::unique_ptr<CommandedMotion> running_;             // lent to the control tick
  std::deque<RequestId> considered_;                     // the last ones: each trajectory has one result
  // Badly signed, for which the one that the service has signed may still come.
  struct Unsigned {
    RequestId id;
    std::string fault;
    std::chrono::steady_clock::time_point refused_at;
  };
  std::deque<Unsigned> unsigned_;
  std::deque<ExecutedRun> unsent_runs_;
  std::chrono::steady_clock::time_point send_runs_again_{};
  DriftWatch drift_watch_;
  std::optional<ArmDrift> drift_;  // last reported
  Lateness lateness_;              // of the tick; the tick's until it has ended
  std::atomic<bool> stopping_ = false, over_ = false;
};

}  // namespace fjr
