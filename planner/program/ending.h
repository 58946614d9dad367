// Ends programs that otherwise run forever on Ctrl-C and similar signals (ending_signals.h).
#pragma once

#include <chrono>
#include <thread>

namespace fjr {

// Makes these signals only set what ending_signalled() returns. In this thread and all it starts they are blocked.
// Threads that a library has started before, such as those of a threaded BLAS, may receive them too; there a handler
// catches them.
void catch_ending_signals();

// Returns whether one of the signals has come, or comes within the time. The calling thread receives them from now on.
bool ending_signalled(std::chrono::nanoseconds within = {});

// Calls what.stop() at the first of the signals. Has to be declared after `what`.
template <class Stoppable>
std::jthread stop_at_end(Stoppable& what) {
  return std::jthread([&what](const std::stop_token& over) {
    while (!over.stop_requested()) {
      if (ending_signalled(std::chrono::milliseconds(100))) return what.stop();
    }
  });
}

}  // namespace fjr
