// One solving process, which is this program started again and controlled over pipes. A crash or an endless solve
// affects only this process and never the service.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "common/descriptor.h"
#include "common/spawn.h"
#include "planner/service/frames.h"
#include "planner/service/repetition_frame.h"
#include "planner/service/solve_loop.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

class Worker {
 public:
  // Called from the worker's own thread: its frames in order, then once without a frame when it has ended.
  using Listener = std::function<void(std::optional<Frame>)>;

  Worker(const WorkerSettings& settings, Listener listener);
  ~Worker();  // kills it, whatever it is doing
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // These functions give an idle worker something to do. If it has ended, they do nothing: the listener is told.
  void solve(const std::string& name, const std::string& yaml);  // plans a request
  void find_stops(const std::vector<Sample>& rows);              // looks for stop motions for these rows
  void find_repetition(const RunOfMotion& run);                  // computes the next repetition of a motion

  pid_t pid() const { return process_.pid(); }

 private:
  void send(std::vector<Frame> frames);

  Child process_;  // declared first, so that it is ended if the construction of any other member fails
  Descriptor to_worker_, from_worker_;
  std::thread listening_;
  std::jthread sending_;
};

}  // namespace fjr
