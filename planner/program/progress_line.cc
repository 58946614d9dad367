#include "planner/program/progress_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace fjr {
namespace {

constexpr std::chrono::milliseconds kPause{100};
constexpr const char* kWipe = "\r\033[K";

std::size_t terminal_width() {
  struct winsize size = {};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col : 80;
}

}  // namespace

ProgressLine::ProgressLine(std::string name) : name_(std::move(name)), terminal_(::isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  if (terminal_) std::fputs(kWipe, stderr);
}

// Whether a line is to be printed now.
bool ProgressLine::due() {
  if (!terminal_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return false;
  next_ = now + kPause;
  return true;
}

void ProgressLine::print(std::string line) const {
  line.resize(std::min(line.size(), terminal_width() - 1));  // a wrapped line could not be wiped
  fmt::print(stderr, "{}{}", kWipe, line);
  std::fflush(stderr);
}

void ProgressLine::show(const Progress& progress) {
  if (!due()) return;
  print(fmt::format("{}: {}, iteration {}, objective {:.6g}, violation {:.1e}", name_, progress.stage,
                    progress.iteration, progress.objective, progress.violation));
}

void ProgressLine::show(const std::string& what) {
  if (due()) print(fmt::format("{}: {}", name_, what));
}

void ProgressLine::show(double fraction) {
  if (due()) print(fmt::format("{}: {:.0f} %", name_, 100 * fraction));
}

}  // namespace fjr
