#include "planner/program/plan_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace fjr {
namespace {

Descriptor checked(int number, const char* what) {
  if (number < 0) throw std::system_error(errno, std::generic_category(), what);
  return Descriptor(number);
}

std::string everything_in(int file) {
  std::string text;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t read = ::pread(file, part.data(), part.size(), static_cast<off_t>(text.size()));
    if (read <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(read));
  }
}

// Returns the first line that it wrote to stderr, without "fjr: " and the line's end.
std::string first_line(int complaints) {
  std::string line = everything_in(complaints);
  line.resize(std::min(line.size(), line.find('\n')));
  return line.starts_with("fjr: ") ? line.substr(5) : line;
}

std::string in_words(int status, int complaints) {
  if (WIFSIGNALED(status)) {
    return fmt::format("the planning process was ended by signal {} ({})", WTERMSIG(status),
                       ::strsignal(WTERMSIG(status)));
  }
  const std::string complaint = first_line(complaints);
  if (!complaint.empty()) return complaint;
  return fmt::format("the planning process ended with exit code {}", WEXITSTATUS(status));
}

}  // namespace

PlanProcess::PlanProcess(std::vector<std::string> arguments)
    : answer_(checked(::memfd_create("fjr plan, stdout", MFD_CLOEXEC), "memfd_create")),
      complaints_(checked(::memfd_create("fjr plan, stderr", MFD_CLOEXEC), "memfd_create")) {
  const Descriptor nothing = checked(::open("/dev/null", O_RDWR | O_CLOEXEC), "/dev/null");
  const std::vector<std::string> head = {"plan", "--json", "--quiet", "--parent", std::to_string(::getpid())};
  arguments.insert(arguments.begin(), head.begin(), head.end());
  process_ = spawn_self(std::move(arguments), nothing.number(), answer_.number(), complaints_.number());
}

std::optional<PlanEnding> PlanProcess::ending() {
  const std::optional<int> status = process_.ended();
  if (!status) return std::nullopt;
  return PlanEnding{in_words(*status, complaints_.number()), everything_in(answer_.number())};
}

void PlanProcess::cancel() const { process_.signal(SIGTERM); }
void PlanProcess::kill() const { process_.signal(SIGKILL); }

}  // namespace fjr
