// A client of the planning service, with timeouts that neither give up too early nor wait forever.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "planner/protocol/execution_messages.h"
#include "planner/protocol/network.h"

namespace fjr {

// No service was found, or it does not answer. what() is one sentence that says what to check.
class NoAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The request was cancelled before a service was found, so nothing was sent.
class NobodyAsked : public NoAnswer {
 public:
  using NoAnswer::NoAnswer;
};

// The request was solved and published, but no executor reported what became of the trajectory.
class NoExecutionResult : public NoAnswer {
 public:
  NoExecutionResult(const std::string& sentence, Reply solved) : NoAnswer(sentence), reply(std::move(solved)) {}

  Reply reply;
};

struct ExecutionProgress {
  double time = 0, duration = 0;  // [s] within the trajectory
  Joints<double> error{};         // [rad] of the links, by their encoders
  ExecutorState state;
};

struct ClientOptions {
  Network network;
  double find = 3;        // [s] to find a service or an executor, since any participant was last discovered
  double ask_again = 2;   // [s] of silence after which the same request is sent again
  double execution = 15;  // [s] beyond the trajectory's duration, from the reply on, for the result
  double silence = 10;    // [s] of silence after which no answer is expected any more
  std::function<void(const ProgressReport&)> on_progress;
  std::function<void(const ExecutionProgress&)> on_execution;
  std::function<bool()> cancelled;  // polled; if true, the request is cancelled, and the reply to that is awaited
  // Stops the arm of the given robot_id (halt.h) if the request is cancelled after the trajectory was published; the
  // executor's result is still awaited. Without this function, the call returns and the execution continues.
  std::function<void(const std::string& robot_id)> stop_execution;
};

struct Answer {
  Reply reply;
  std::optional<ExecutionResult> result;  // set if the motion was solved and was to be executed
};

// Sends the order under its id and returns the final reply and, if it is to be executed, the result of the execution.
// Throws NobodyAsked if it was cancelled before a service was found, NoAnswer if there is no service or none that
// answers in time, NoExecutionResult if the result of the execution does not come, and InputError if the document is
// not a request.
Answer request_plan(const Order& order, const ClientOptions& options);

// The latest state of every service (by instance) and executor (by robot) that was heard within `wait` [s]. While none
// is heard, it waits longer as long as further participants are discovered.
struct Overview {
  std::vector<ServiceStatus> services;
  std::vector<ExecutorState> executors;  // contains both if two executors claim one robot
  std::vector<ArmDrift> drifts;          // of robots whose motions were evaluated
  std::optional<std::string> strangers;  // if no service is found: a sentence about participants that reveal nothing
  double looked = 0;                     // [s] spent
};
Overview overview(const Network& network, double wait);

// Gives such overviews repeatedly. Each contains only what was heard during it, except for drifts, which are rarely
// published.
class Lookout {
 public:
  explicit Lookout(const Network& network);
  ~Lookout();
  Lookout(const Lookout&) = delete;
  Lookout& operator=(const Lookout&) = delete;

  Overview look(double wait, const std::function<bool()>& enough = {});  // ends early once enough() is true

 private:
  struct Seen;
  std::unique_ptr<Seen> seen_;
};

}  // namespace fjr
