// Asking a planning service, and not giving up too early nor waiting forever.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/protocol/execution_messages.h"
#include "planner/protocol/network.h"

namespace fjr {

// Nobody takes requests, or whoever does is silent. One sentence that says what to look at.
class NoAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// It was cancelled before anybody was there to be asked: nothing was sent.
class NobodyAsked : public NoAnswer {
 public:
  using NoAnswer::NoAnswer;
};

struct ExecutionProgress {
  double time = 0, duration = 0;  // [s] within the trajectory
  Joints<double> error{};         // [rad] of the links, by their encoders
  ExecutorState state;
};

struct ClientOptions {
  Network network;
  double find = 3;        // [s] to find a service, since somebody was last met; and an executor
  double ask_again = 2;   // [s] of silence after which the same request is sent again
  double execution = 15;  // [s] beyond the trajectory's duration for the executor to report
  double silence = 10;    // [s] after which nobody is expected to answer any more
  std::function<void(const ProgressReport&)> on_progress;
  std::function<void(const ExecutionProgress&)> on_execution;
  std::function<bool()> cancelled;  // polled; then the request is cancelled, which is answered too
  // How to stop the arm of that robot_id (halt.h), for a cancellation that comes once the trajectory is published: the
  // executor's result is waited for even so. Without it nobody waits, and the execution goes on.
  std::function<void(const std::string& robot_id)> stop_execution;
};

struct Answer {
  Reply reply;
  std::optional<ExecutionResult> result;  // when it was solved and to be executed
};

// Sends the order under its id and returns the final reply, and of an order that is to be executed what became of the
// execution. Throws NobodyAsked when it was cancelled before a service was found, NoAnswer when there is none, or none
// that answers in time, and InputError for a document that has not the shape of a request.
Answer request_plan(const Order& order, const ClientOptions& options);

// The latest state of every service and executor that was heard within `wait` [s]; while none is heard, for as long as
// further participants are discovered. Services by instance, executors by robot.
struct Overview {
  std::vector<ServiceStatus> services;
  std::vector<ExecutorState> executors;  // two that speak for one robot are two
  std::vector<ArmDrift> drifts;          // of robots, as far as motions were looked at
  std::optional<std::string> strangers;  // without services: one sentence on who lets nothing be seen
  double looked = 0;                     // [s]
};
Overview overview(const Network& network, double wait);

// The same again and again. What each look tells was heard during it, but for the drifts, which are seldom told.
class Lookout {
 public:
  explicit Lookout(const Network& network);
  ~Lookout();
  Lookout(const Lookout&) = delete;
  Lookout& operator=(const Lookout&) = delete;

  Overview look(double wait, const std::function<bool()>& enough = {});  // enough: polled; then the look ends

 private:
  struct Seen;
  std::unique_ptr<Seen> seen_;
};

}  // namespace fjr
