// Planning as a service: admits requests, queues them, has them solved in worker processes, answers. One thread does
// all of it; workers and signals only leave word and wake it.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "model/parameters.h"
#include "planner/service/dds/service_port.h"
#include "planner/service/job_queue.h"
#include "planner/service/log_limit.h"
#include "planner/service/reply_cache.h"
#include "planner/service/service_config.h"
#include "planner/service/tally.h"
#include "planner/service/worker.h"

namespace fjr {

class Service {
 public:
  explicit Service(const ServiceConfig& config);

  void run();   // until stop(); then answers what is in flight
  void stop();  // from any thread

 private:
  using Clock = Job::Clock;

  struct Event {  // a worker's word
    std::uint64_t worker;
    std::optional<Frame> frame;  // none: it has ended
  };
  struct Solver {  // a worker and what it is doing
    std::uint64_t serial = 0;
    std::unique_ptr<Worker> worker;  // none: to be started again
    std::optional<Job> job;
    Reply result;  // as far as it has come
  };

  void admit(Order order);
  std::optional<Refusal> refusal_of(const Order& order, std::string& request_hash) const;
  bool repeat(const Order& order);
  bool in_hand(const RequestId& id) const;
  void cancel(const RequestId& id);
  void handle(Event event);
  void take_frame(Solver& solver, Frame frame);
  void lose(Solver& solver);
  void report_progress(const Solver& solver, const std::string& payload);
  void expire();
  void give_work();
  void start_workers();
  void replace(Solver& solver);
  void heartbeat();
  std::chrono::nanoseconds time_to_next() const;
  void answer_all_in_flight();

  Reply reply_to(const Order& order, ReplyState state, Refusal why = {}) const;
  void finish(const Job& job, Reply reply);
  void give_up(const Job& job, ReplyState state, Reason reason, const std::string& sentence);
  void reject(const Order& order, Refusal why, bool remember);
  void publish(const Reply& reply);
  void send(const Reply& reply);
  std::vector<Event> take_events();

  const ServiceConfig config_;
  const std::string robot_hash_;
  const Clock::time_point began_ = Clock::now();
  dds::ServicePort port_;
  std::atomic<bool> stopping_ = false;

  std::mutex events_mutex_;
  std::vector<Event> events_;

  JobQueue queue_;
  ReplyCache cache_;
  Tally tally_;
  LogLimit log_refusals_, log_slow_clients_;
  Clock::time_point next_heartbeat_{};
  std::uint64_t next_serial_ = 1;
  std::vector<Solver> solvers_;  // last: their threads end before what they speak to
};

}  // namespace fjr
