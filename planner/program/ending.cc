#include "planner/program/ending.h"

#include <semaphore.h>
#include <signal.h>

#include <ctime>

#include "planner/program/ending_signals.h"

namespace fjr {
namespace {

sem_t g_signalled;  // a semaphore, because a signal handler may post to it
volatile sig_atomic_t g_any = 0;

// Handles the signals. When systemd ends a session, SIGHUP follows SIGTERM and is no second request.
extern "C" void note_ending(int signal) {
  if (signal == SIGHUP && g_any != 0) return;
  g_any = 1;
  ::sem_post(&g_signalled);
}

sigset_t set_of_ending_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : ending_signals()) sigaddset(&signals, signal);
  return signals;
}

}  // namespace

void catch_ending_signals() {
  ::sem_init(&g_signalled, 0, 0);
  struct sigaction action = {};
  action.sa_handler = note_ending;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : ending_signals()) ::sigaction(signal, &action, nullptr);
  const sigset_t signals = set_of_ending_signals();
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

bool ending_signalled(std::chrono::nanoseconds within) {
  const sigset_t signals = set_of_ending_signals();
  ::pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  constexpr long kSecond = 1'000'000'000;
  timespec until{};
  ::clock_gettime(CLOCK_MONOTONIC, &until);
  const long nanoseconds = until.tv_nsec + within.count();
  until.tv_sec += nanoseconds / kSecond;
  until.tv_nsec = nanoseconds % kSecond;
  return ::sem_clockwait(&g_signalled, CLOCK_MONOTONIC, &until) ==
         0;  // nonzero: the time is over, or the call was interrupted
}

}  // namespace fjr
