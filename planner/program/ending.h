// Ctrl-C and its like (ending_signals.h) as the end of a program that otherwise runs forever.
#pragma once

#include <chrono>
#include <thread>

namespace fjr {

// From now on these signals only tell ending_signalled(). In this thread and all it starts they are blocked.
// Threads that a library has started before, as a threaded BLAS does when it is loaded, take them too: there they are
// caught.
void catch_ending_signals();

// Whether one of them has come, or comes within the time. The calling thread takes them from now on.
bool ending_signalled(std::chrono::nanoseconds within = {});

// Calls what.stop() at the first of them. To be declared after `what`.
template <class Stoppable>
std::jthread stop_at_end(Stoppable& what) {
  return std::jthread([&what](const std::stop_token& over) {
    while (!over.stop_requested()) {
      if (ending_signalled(std::chrono::milliseconds(100))) return what.stop();
    }
  });
}

}  // namespace fjr
