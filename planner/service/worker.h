// One solving process: this program again, spoken to over pipes. A crash or an overdue solve costs this process, never
// the service.
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

  // False: it is gone.
  bool solve(const std::string& name, const std::string& yaml);

  // Stop motions for these rows, which are too many for a pipe to take them at once: a thread waits for that.
  void find_stops(std::vector<Sample> rows);

  // The next repetition of a motion, likewise.
  void find_repetition(RunOfMotion run);

  pid_t pid() const { return process_.pid(); }

 private:
  Child process_;  // begun before all others, and therefore ended whichever of them cannot be had
  Descriptor to_worker_, from_worker_;
  std::thread listening_;
  std::jthread sending_;
};

}  // namespace fjr
