// The service's side of the protocol.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "planner/dds/client_writers.h"
#include "planner/dds/executor_states.h"
#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/dds/senders.h"
#include "planner/dds/waitset.h"
#include "planner/dds/wire_request.h"
#include "planner/dds/writer.h"
#include "planner/protocol/execution_messages.h"
#include "planner/protocol/messages.h"

namespace fjr::dds {

class ServicePort {
 public:
  explicit ServicePort(Participant participant);

  // Waits until something arrives, wake() is called (from any thread) or the timeout is over. The executor's states, a
  // thousand per second, and other instances' replies do not end the wait.
  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }
  void wake() const { waitset_.wake(); }

  // Begins to receive requests and cancellations.
  void open();
  bool is_open() const { return plan_requests_.has_value(); }

  // Returns a bounded number of requests, so that a flood of them leaves time for everything else.
  std::vector<Order> take_requests();
  struct Cancel {
    RequestId id;
    std::optional<std::string> robot_id;  // empty if sent by an earlier version
    Origin origin{};
  };
  std::vector<Cancel> take_cancels();

  // Between instances.
  std::vector<Relayed> take_relayed();
  void relay(const Relayed& relayed) { (void)relayed_.write(encode(relayed)); }  // they may have it already
  void flush_relayed(std::chrono::nanoseconds timeout) const { (void)relayed_.flush(timeout.count()); }

  // Returns whether a writer of requests of that participant exists.
  bool present(const Origin& origin) const { return senders_.present(origin); }
  void look_for_senders();  // takes notice of who has left

  struct Peer {
    ServiceStatus status;  // of one that is gone only the instance
    bool alive = false;
  };
  std::vector<Peer> take_peers();
  std::vector<Reply> take_replies_of_others();
  struct Executor {
    ExecutorState state;  // of one that is gone only the robot
    bool alive = false;
    ExecutorStates::Source source = 0;  // distinguishes two executors that claim one robot
  };
  std::vector<Executor> take_executors();
  std::vector<ExecutionResult> take_results();  // of trajectories that were executed or refused
  std::vector<ArmDrift> take_drifts();          // drift reports of executors of any robot
  std::vector<ExecutedRun> take_runs();         // logged runs of executors of any robot

  const Participant& participant() const { return participant_; }
  Waitset& waitset() { return waitset_; }
  ClientWriters& clients() { return clients_; }
  void send(const ServiceStatus& status);

  // Trajectories are published by their robot's owner only.
  void own(std::uint64_t epoch);
  void disown();
  bool send(const TrajectoryOrder& order);                       // to the executor; false: it is too slow
  bool learnt_are_taken(ExecutorStates::Source executor) const;  // whether that executor accepts learnt trajectories

 private:
  Participant participant_;
  Waitset waitset_;
  Entity everywhere_;  // a subscriber in all clients' partitions
  std::optional<Reader<fjr_msg_MotionCancel>> motion_cancels_;
  std::optional<Reader<fjr_msg_PlanCancel>> plan_cancels_;
  std::optional<Reader<fjr_msg_MotionRequest>> motion_requests_;
  std::optional<Reader<fjr_msg_PlanRequest2>> plan_requests_2_;
  std::optional<Reader<fjr_msg_PlanRequest>> plan_requests_;
  Senders senders_;
  Reader<fjr_msg_RelayedRequest> relayed_by_others_;
  Writer<fjr_msg_RelayedRequest> relayed_;
  Reader<fjr_msg_PlannerStatus> peers_;
  Reader<fjr_msg_PlanReply> replies_of_others_;
  Reader<fjr_msg_ExecutorState> executors_;
  Reader<fjr_msg_ExecutionResult> results_;
  std::optional<Reader<fjr_msg_ArmDrift>> drifts_;
  std::optional<Reader<fjr_msg_ExecutedRun>> runs_;
  Writer<fjr_msg_PlannerStatus> status_;
  std::optional<Writer<fjr_msg_Trajectory2>> trajectories_2_;
  std::optional<Writer<fjr_msg_Trajectory>> trajectories_;
  std::optional<Writer<fjr_msg_LearntTrajectory>> learnt_trajectories_;
  ClientWriters clients_;
};

}  // namespace fjr::dds
