// Starts this program again as a child process by posix_spawn(). A fork() without exec would not be
// safe, because DDS has threads.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <vector>

namespace fjr {

// A child process. Its destructor ends it and waits for it.
class Child {
 public:
  Child() = default;  // none
  explicit Child(pid_t pid) : pid_(pid) {}
  ~Child();
  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;

  pid_t pid() const { return pid_; }
  void signal(int number) const;  // nothing where it has ended and ended() has said so

  // Returns its status as from waitpid(), once; nothing while it runs.
  std::optional<int> ended();

 private:
  pid_t pid_ = -1;
};

// Starts `fjr WORDS...` with these descriptors as stdin, stdout and stderr; no other descriptors are inherited, and no
// signals are blocked. It has a process group of its own, so that Ctrl-C reaches only the parent. SIGPIPE and SIGXFSZ
// end it; other signals that are ignored here are ignored there. Throws std::system_error.
Child spawn_self(std::vector<std::string> words, int in, int out, int err = STDERR_FILENO);

}  // namespace fjr
