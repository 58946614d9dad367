// This program again, as a process of its own: fork and exec, never fork alone (DDS has threads).
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <vector>

namespace fjr {

// A process of ours. Ended and waited for when it goes out of scope, so that none is left behind.
class Child {
 public:
  Child() = default;  // none
  explicit Child(pid_t pid) : pid_(pid) {}
  ~Child();
  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;

  pid_t pid() const { return pid_; }
  void signal(int number) const;  // nothing where it has ended and ended() has said so

  // Its status as waitpid() tells it, once; nothing while it runs.
  std::optional<int> ended();

 private:
  pid_t pid_ = -1;
};

// Starts `fjr WORDS...` with these descriptors as stdin, stdout and stderr and nothing else of ours, no signal blocked,
// and a process group of its own: Ctrl-C is meant for the parent. Broken pipes and full files end it; other signals
// that are ignored here are ignored there. Throws std::system_error.
Child spawn_self(std::vector<std::string> words, int in, int out, int err = STDERR_FILENO);

}  // namespace fjr
