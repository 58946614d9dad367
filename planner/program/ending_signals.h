// The signals that ask a program to end.
#pragma once

#include <signal.h>

#include <vector>

namespace fjr {

// Ctrl-C, SIGTERM, and SIGHUP, which comes when the terminal is closed; not under nohup, which has that one ignored.
inline std::vector<int> ending_signals() {
  std::vector<int> signals{SIGINT, SIGTERM};
  struct sigaction now = {};
  if (::sigaction(SIGHUP, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) signals.push_back(SIGHUP);
  return signals;
}

}  // namespace fjr
