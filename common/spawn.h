// This program again, as a process of its own: fork and exec, never fork alone (DDS has threads).
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace fjr {

// Starts `fjr WORDS...` with these descriptors as stdin, stdout and stderr and nothing else of ours, signals as they
// are for a fresh program, and a process group of its own: Ctrl-C is meant for the parent. Throws std::system_error.
pid_t spawn_self(std::vector<std::string> words, int in, int out, int err = STDERR_FILENO);

}  // namespace fjr
