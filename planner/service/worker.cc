#include "planner/service/worker.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace fjr {
namespace {

struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    from = Descriptor(ends[0]);
    to = Descriptor(ends[1]);
  }
  Descriptor from, to;
};

// What posix_spawn is told: the pipes as stdin and stdout, nothing else of ours but stderr, signals as they are for a
// fresh program, and a process group of its own: Ctrl-C is meant for the service.
class SpawnSettings {
 public:
  SpawnSettings(int in, int out) {
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    posix_spawnattr_init(&attributes);
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
};

pid_t spawn(const WorkerSettings& worker, int in, int out) {
  const SpawnSettings settings(in, out);
  std::array<std::string, 6> words{
      "fjr", "worker", "--robot", worker.robot.string(), "--warm-plans", std::to_string(worker.warm_plans)};
  std::array<char*, words.size() + 1> argv{};
  std::transform(words.begin(), words.end(), argv.begin(), [](std::string& word) { return word.data(); });
  pid_t pid = -1;
  const int error =
      ::posix_spawn(&pid, "/proc/self/exe", &settings.actions, &settings.attributes, argv.data(), environ);
  if (error != 0) throw std::system_error(error, std::generic_category(), "cannot start a worker process");
  return pid;
}

}  // namespace

Worker::Worker(const WorkerSettings& settings, Listener listener) {
  Pipe requests, results;
  pid_ = spawn(settings, requests.from.number(), results.to.number());
  to_worker_ = std::move(requests.to);
  from_worker_ = std::move(results.from);
  listening_ = std::thread([from = from_worker_.number(), tell = std::move(listener)] {
    while (auto frame = read_frame(from)) tell(std::move(frame));
    tell(std::nullopt);
  });
}

Worker::~Worker() {
  ::kill(pid_, SIGKILL);
  listening_.join();
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
}

bool Worker::solve(const std::string& name, const std::string& yaml) {
  return write_frame(to_worker_.number(), FrameKind::kName, name) &&
         write_frame(to_worker_.number(), FrameKind::kSolve, yaml);
}

}  // namespace fjr
