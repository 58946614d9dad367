#include "planner/program/progress_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "common/say.h"

namespace fjr {
namespace {

constexpr std::chrono::milliseconds kPause{100};  // on a terminal
constexpr std::chrono::seconds kSilence{10};      // elsewhere
constexpr double kTelling = 1;                    // [s] after which the rate of work is meaningful
constexpr const char* kWipe = "\r\033[K";

std::size_t terminal_width() {
  struct winsize size = {};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col : 80;
}

// Returns what is known about the remaining time. The remaining starts take about as long as those before them, and the
// whole search ends with the work it may do, or at its deadline. How long refining takes is not known before.
std::string time_left(const Progress& p, double elapsed) {
  std::string text;
  if (elapsed < kTelling) return text;
  if (p.phase == Phase::kFinding && p.starts > 0 && p.starts < p.starts_planned) {
    text = fmt::format(", {} more starts in about {}", p.starts_planned - p.starts,
                       time_in_words(elapsed * (p.starts_planned - p.starts) / p.starts));
  }
  double most = p.most_work > 0 && p.work > 0 ? elapsed * std::max(0.0, p.most_work / p.work - 1) : kNoLimit;
  if (p.deadline > 0) most = std::min(most, std::max(0.0, p.deadline - elapsed));
  if (most < kNoLimit) text += fmt::format(", at most about {} more", time_in_words(most));
  return text;
}

}  // namespace

std::string time_in_words(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  return seconds < 90 * 60 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

void add_talk(CLI::App& command, Talk& talk) {
  CLI::Option* const quiet = command.add_flag_callback(
      "-q,--quiet", [&talk] { talk = Talk::kNothing; }, "Say nothing of the progress on stderr");
  command
      .add_flag_callback(
          "-v,--verbose", [&talk] { talk = Talk::kMore; },
          "Say on stderr whatever is begun, beside a line every ten seconds (on a terminal: one that is rewritten)")
      ->excludes(quiet);
}

ProgressLine::Output ProgressLine::Output::on_stderr() { return {stderr, ::isatty(STDERR_FILENO) != 0, Clock::now}; }

ProgressLine::ProgressLine(std::string name, Talk talk, Output output)
    : name_(std::move(name)),
      talk_(talk),
      output_(std::move(output)),
      began_(output_.now()),
      next_(output_.terminal ? began_ : began_ + kSilence) {}

ProgressLine::~ProgressLine() {
  if (output_.terminal && talk_ != Talk::kNothing) std::fputs(kWipe, output_.file);
}

double ProgressLine::elapsed() const { return std::chrono::duration<double>(output_.now() - began_).count(); }

// Returns whether a line is to be printed now.
bool ProgressLine::due() {
  if (talk_ == Talk::kNothing) return false;
  const auto now = output_.now();
  if (now < next_) return false;
  next_ = now + (output_.terminal ? Clock::duration(kPause) : Clock::duration(kSilence));
  return true;
}

void ProgressLine::begin(const std::string& what) {
  if (talk_ != Talk::kMore || what == doing_) return;
  doing_ = what;
  say_in(output_.file, "{}fjr: {}: {:.1f} s: {}\n", output_.terminal ? kWipe : "", name_, elapsed(), what);
  std::fflush(output_.file);
}

void ProgressLine::print(std::string line) const {
  if (output_.terminal) {
    line.resize(std::min(line.size(), terminal_width() - 1));  // a wrapped line could not be wiped
    say_in(output_.file, "{}{}", kWipe, line);
  } else {
    say_in(output_.file, "fjr: {}\n", line);
  }
  std::fflush(output_.file);
}

void ProgressLine::show(const Progress& progress) {
  begin(progress.stage);
  if (!due()) return;
  const double seconds = elapsed();
  print(fmt::format("{}: {}{}: {}, iteration {}, objective {:.6g}, violation {:.1e}", name_, time_in_words(seconds),
                    time_left(progress, seconds), progress.stage, progress.iteration, progress.objective,
                    progress.violation));
}

void ProgressLine::show(const std::string& what) {
  if (due()) print(fmt::format("{}: {}: {}", name_, time_in_words(elapsed()), what));
}

void ProgressLine::show(double fraction) {
  if (!due()) return;
  const double seconds = elapsed();
  const std::string left = fraction > 0 && seconds >= kTelling
                               ? fmt::format(", about {} more", time_in_words(seconds * (1 / fraction - 1)))
                               : "";
  print(fmt::format("{}: {:.0f} %, {}{}", name_, 100 * fraction, time_in_words(seconds), left));
}

}  // namespace fjr
