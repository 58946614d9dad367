#include "planner/service/worker.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <system_error>
#include <utility>
#include <vector>

#include "common/spawn.h"

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

}  // namespace

Worker::Worker(const WorkerSettings& settings, Listener listener) {
  Pipe requests, results;
  std::vector<std::string> words = {"worker",
                                    "--robot",
                                    settings.robot.string(),
                                    "--warm-plans",
                                    std::to_string(settings.warm_plans),
                                    "--jobs",
                                    std::to_string(settings.jobs)};
  if (settings.rehearsal > 0) words.insert(words.end(), {"--rehearse", std::to_string(settings.rehearsal)});
  if (!settings.library.empty()) words.insert(words.end(), {"--library", settings.library.string()});
  process_ = spawn_self(words, requests.from.number(), results.to.number());
  to_worker_ = std::move(requests.to);
  from_worker_ = std::move(results.from);
  listening_ = std::thread([from = from_worker_.number(), tell = std::move(listener)] {
    while (auto frame = read_frame(from)) tell(std::move(frame));
    tell(std::nullopt);
  });
}

Worker::~Worker() {
  process_.signal(SIGKILL);
  listening_.join();
}

// Frames are written by a thread, because they may exceed the buffer of the pipe, and the service must not wait. The
// worker has read all earlier ones when it gets more to do, so that their thread has ended. Where no thread can be
// started, the process is ended; its job is solved again, as after a crash.
void Worker::send(std::vector<Frame> frames) {
  try {
    sending_ = std::jthread([to = to_worker_.number(), sent = std::move(frames)] {
      for (const Frame& frame : sent) {
        if (!write_frame(to, frame.kind, frame.payload)) return;
      }
    });
  } catch (const std::system_error&) {
    process_.signal(SIGKILL);
  }
}

void Worker::solve(const std::string& name, const std::string& yaml) {
  send({{FrameKind::kName, name}, {FrameKind::kSolve, yaml}});
}

void Worker::find_repetition(const RunOfMotion& run) { send({{FrameKind::kFindRepetition, to_payload(run)}}); }

void Worker::find_stops(const std::vector<Sample>& rows) {
  send({{FrameKind::kFindStops, std::string(as_payload(rows))}});
}

}  // namespace fjr
