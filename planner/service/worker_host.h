// `fjr serve --worker-only`: solves for the owners of its robot on other machines. It takes as many leases as it has
// solving processes, repeatedly announces which ones it holds, and keeps each result until the owner has taken it. If
// one process does so for several robots, which share its processors, leased jobs may wait for their turn.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planner/dds/worker_port.h"
#include "planner/protocol/log_limit.h"
#include "planner/service/companions.h"
#include "planner/service/service_config.h"
#include "planner/service/solvers.h"

namespace fjr {

class WorkerHost {
 public:
  // Uses the network, the instance, the robot and the solving options of the configuration.
  WorkerHost(const ServiceConfig& config, Companion companion);

  // Runs until stop(), then returns its leases. Throws InputError if the owner of its robot has a different robot.yaml.
  void run();
  void stop();  // from any thread

 private:
  using Clock = Job::Clock;
  struct Held {
    std::string instance;  // of the owner
    Progress progress;
    std::optional<WorkResult> result;
    Clock::time_point say_at;  // the result, again
  };
  struct Owner {
    std::uint64_t process = 0;
    Clock::time_point heard;
  };

  void heartbeat();
  void send_offer();
  void look_for_owners();
  void drop_if_owned_by(const std::string& instance);
  void receive(LeaseWord word);
  void begin(LeaseWord word);
  void drop(const LeaseId& lease);
  void give_work();
  void return_what_cannot_be_solved();
  void refused(const LeaseWord& word);
  void take_news();
  void conclude(const RequestId& id, WorkResult result);
  void say_results();
  void end();

  const ServiceConfig config_;
  const Companion companion_;
  const std::string robot_hash_;
  const WorkerId worker_;
  dds::WorkerPort port_;
  std::atomic<bool> stopping_ = false;
  Clock::time_point next_heartbeat_{};
  std::map<LeaseId, Held> held_;
  std::deque<Job> waiting_;              // held jobs that wait for their turn; at most one per idle process
  std::map<std::string, Owner> owners_;  // by instance; standbys, too
  std::string refused_;                  // the sentence that was logged
  LogLimit log_;
  Solvers solvers_;  // last: they wake the port
};

}  // namespace fjr
