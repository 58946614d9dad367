// The signals that ask a program to end.
#pragma once

#include <signal.h>

#include <vector>

namespace fjr {

// Returns the signals: Ctrl-C, SIGTERM, and SIGHUP, which comes when the terminal is closed. Under nohup SIGHUP is left
// out because it is ignored there.
inline std::vector<int> ending_signals() {
  std::vector<int> signals{SIGINT, SIGTERM};
  struct sigaction now = {};
  if (::sigaction(SIGHUP, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) signals.push_back(SIGHUP);
  return signals;
}

}  // namespace fjr
