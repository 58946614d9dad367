// SIGTERM and SIGINT as the end of a program that otherwise runs forever.
#pragma once

#include <signal.h>

#include <ctime>
#include <thread>

namespace fjr {

inline sigset_t ending_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signals;
}

// In this thread and all it starts: only the thread of stop_at_end() takes them, where anything may be called.
inline void block_ending_signals() {
  const sigset_t signals = ending_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

// Calls what.stop() at the first of them. To be declared after `what`.
template <class Stoppable>
std::jthread stop_at_end(Stoppable& what) {
  return std::jthread([&what](const std::stop_token& over) {
    const sigset_t signals = ending_signals();
    const timespec a_while{0, 100'000'000};
    while (!over.stop_requested()) {
      if (sigtimedwait(&signals, nullptr, &a_while) > 0) return what.stop();
    }
  });
}

}  // namespace fjr
