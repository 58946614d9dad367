// Planning as a service: admits requests, queues them, has them solved in worker processes, and replies. A single
// thread does all of this; workers and signals only leave messages and wake it.
//
// If there are several instances for a robot, one of them, the owner, answers. The others remember what they hear and
// take over when the owner is gone (ownership.h). A service serves one robot; a process may contain several services
// (one_per_robot.h).
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "model/parameters.h"
#include "planner/dds/joint_trajectory.h"
#include "planner/dds/service_port.h"
#include "planner/protocol/log_limit.h"
#include "planner/protocol/signature.h"
#include "planner/service/admission.h"
#include "planner/service/backlog.h"
#include "planner/service/companions.h"
#include "planner/service/executed_runs.h"
#include "planner/service/executor_watch.h"
#include "planner/service/inbox.h"
#include "planner/service/job_queue.h"
#include "planner/service/outbox.h"
#include "planner/service/ownership.h"
#include "planner/service/presence.h"
#include "planner/service/recent_ids.h"
#include "planner/service/refused_repetitions.h"
#include "planner/service/reply_cache.h"
#include "planner/service/reply_store.h"
#include "planner/service/service_config.h"
#include "planner/service/slots.h"
#include "planner/service/tally.h"
#include "planner/service/unclaimed.h"

namespace fjr {

class Service {
 public:
  Service(const ServiceConfig& config, Companion companion);

  void run();   // returns after stop(), when pending requests are answered or handed over
  void stop();  // from any thread

 private:
  using Clock = Job::Clock;
  struct Answer {  // a final reply, and the request it answers
    Order order;
    Clock::time_point arrived;
    SharedReply reply;
  };

  // Incoming requests and cancellations (mostly in service_incoming.cc).
  void take_in();
  bool fill_inbox(Clock::duration most);
  void receive(Order order);
  bool answers(const Order& order) const;
  bool answers(const Backlog::Entry& entry) const;
  bool knows_executor() const;
  void note_what_it_needs(Order& order) const;
  void keep(Order order, Clock::time_point arrived, Clock::time_point heard, bool relay);
  void keep_cancel(const dds::ServicePort::Cancel& wanted, bool relay);
  void no_room_for(const std::optional<Order>& dropped);
  // heard: the last sign of life of its client.
  void admit(Order order, Clock::time_point arrived, Clock::time_point heard);
  Served served() const;
  std::optional<Refusal> resolve_start(Request& request) const;
  void enqueue(Job job, Clock::time_point arrived);
  void execute_planned(const Order& order, Clock::time_point arrived);
  bool answer_again(const Order& order);
  bool in_hand(const RequestId& id) const;
  bool being_stored(const RequestId& id) const;
  bool motion_pending() const;
  void cancel(const dds::ServicePort::Cancel& wanted);
  bool answers_cancel(const std::string& robot_id) const;

  // Repetitions (service_repetitions.cc).
  RequestId motion_of(const RequestId& trajectory_id) const;
  bool is_run_of(const RequestId& motion, const RequestId& trajectory_id) const;
  std::optional<RequestId> run_on_its_way() const;
  bool has_its_run(const Job& job) const;
  void repeat_motion(const Order& order, Clock::time_point arrived);
  std::optional<Refusal> choose_run(Job& job) const;
  std::optional<Refusal> refusal_of_learnt() const;

  // Liveness of clients (service_clients.cc).
  bool may_start(const Order& order);
  void listen_for(const Order& order);
  void look_after_clients();
  void ask(const Order& order);
  std::vector<const Order*> orders_in_hand() const;
  void meet_clients();

  // Solving and deadlines (service_work.cc, service.cc), and the end (service_end.cc).
  void work();
  void expire();
  void give_work();
  void heartbeat();
  ServiceStatus status() const;
  void publish_metrics(const ServiceStatus& status);
  std::chrono::nanoseconds time_to_next() const;
  void end();
  void take_last_cancels();
  std::vector<Backlog::Entry> last_requests();
  void conclude(const Backlog::Entry& entry);
  void refuse_at_end(const Backlog::Entry& last);
  void hand_over();

  // Other instances and the executor (service_others.cc; results and runs: service_repetitions.cc).
  // Returns whether this instance knows the others: it has listened long enough, and was not suspended for so long that
  // they may consider it gone.
  bool settled() const;
  void listen_to_others();
  void hear(const dds::ServicePort::Peer& peer);
  void hear(dds::Relayed relayed);
  void hear(Reply reply);
  void hear(ArmDrift drift);
  void hear(const ExecutionResult& result);
  void hear(ExecutedRun run);
  void complete(Reply& overheard) const;
  bool takes_part(const ServiceStatus& other) const;
  void relay();
  void open();
  void review_ownership();
  void take_over();
  void answer_backlog();
  void give_up_ownership();

  // Outgoing replies and trajectories (service_replies.cc).
  Reply reply_to(const Order& order, ReplyState state, Refusal why = {}) const;
  void finish(const Job& job, Reply reply);
  void give_up(const Job& job, ReplyState state, Reason reason, const std::string& sentence);
  void remember(const SharedReply& reply);
  void reject(const Order& order, Refusal why);
  void settle(Answer answer);
  void release(const Answer& answer);
  void release_if_it_may_start(Answer answer);
  void release_stored();
  void await_stored(Clock::time_point over);
  std::optional<Refusal> refusal_to_publish(const std::vector<Sample>& rows, bool learnt) const;
  void publish(const Reply& reply);
  bool send(const SharedReply& reply);
  void post(SharedReply reply);

  const ServiceConfig config_;
  const Companion companion_;
  const Parameters robot_;
  const std::string robot_hash_;
  const Clock::time_point began_ = Clock::now();
  const std::optional<Signer> signer_;  // none: a domain without DDS Security
  dds::ServicePort port_;
  std::optional<dds::JointTrajectoryWriter> ros_;
  std::atomic<bool> stopping_ = false;

  Ownership ownership_;
  ExecutorWatch executor_;
  std::optional<ArmDrift> drift_;  // last heard of the robot's arm
  Backlog backlog_;
  Inbox inbox_;
  Presence presence_;
  // This process was suspended, so requests that are read now may have waited. Their clients may be gone and are asked
  // first.
  bool waited_ = false;
  Clock::time_point settled_at_;  // when the other instances will be known
  bool owned_ = false;            // the robot, before the last review
  Clock::time_point took_over_at_{};
  bool answering_ = false;  // more of the backlog can be answered at once
  Clock::time_point next_heartbeat_{}, last_heartbeat_ = Clock::now();

  JobQueue queue_;
  ReplyCache cache_;
  ExecutedRuns runs_;
  RefusedRepetitions refused_repetitions_;
  RecentIds refused_lately_;  // refused for a temporary reason
  Unclaimed unclaimed_;
  Outbox outbox_;
  Tally tally_;
  LogLimit log_requests_, log_refusals_, log_slow_clients_, log_others_;
  std::vector<Answer> being_stored_;  // sent when they are on disk
  std::optional<ReplyStore> store_;   // none: a restarted service remembers nothing
  Slots solvers_;                     // declared last, as store_ and solvers_ wake the port from their threads
};

}  // namespace fjr
