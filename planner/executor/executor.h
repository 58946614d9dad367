// Runs received trajectories on an arm. The control tick has a thread of its own; everything else runs in the caller's.
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

  void run();                        // returns after stop(), when the arm has been brought to rest
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
  std::optional<SignatureCheck> signatures_;  // empty in a domain without DDS Security
  History history_;
  const StampClock clock_;
  Control control_;
  Situation situation_;
  // A trajectory that passed the first checks, while a thread prepares it.
  struct Preparation {
    using Clock = std::chrono::steady_clock;
    TrajectoryOrder header;  // without rows and stops
    bool brings_stops = false;
    Clock::time_point began;
    std::stop_source unwanted;
    std::future<std::unique_ptr<CommandedMotion>> motion;  // declared last: its destructor waits for the thread
  };
  std::optional<Preparation> preparing_;
  TickState latest_;
  Claimant self_;
  std::chrono::steady_clock::time_point other_heard_{};  // when another executor of the robot last reported
  std::optional<std::string> superseded_;                // set if another executor took over: one sentence
  bool ticking_ = false;                                 // latest_ is set
  std::unique_ptr<CommandedMotion> running_;             // lent to the control tick
  std::deque<RequestId> considered_;                     // the last ones: each trajectory has one result
  // A trajectory without valid signature, of which a copy signed by the service may still arrive.
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
  Lateness lateness_;              // of the tick; only its thread may use it until that has ended
  std::atomic<bool> stopping_ = false, over_ = false;
};

}  // namespace fjr
