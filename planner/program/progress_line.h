// Shows the progress of long computations on stderr: on a terminal one line that is rewritten, elsewhere a line every
// ten seconds.
#pragma once

#include <chrono>
#include <cstdio>
#include <functional>
#include <string>

#include "planner/plan.h"

namespace CLI {
class App;
}

namespace fjr {

enum class Talk {
  kNothing,  // -q
  kUsual,
  kMore,  // -v: also prints a line when something begins
};

// Adds the options -q and -v.
void add_talk(CLI::App& command, Talk& talk);

// Returns a time in words: "85 s", "12 min", "3.4 h".
std::string time_in_words(double seconds);

class ProgressLine {
 public:
  using Clock = std::chrono::steady_clock;

  // The file that lines are written to, and the clock.
  struct Output {
    std::FILE* file;
    bool terminal;
    std::function<Clock::time_point()> now;

    static Output on_stderr();
  };

  explicit ProgressLine(std::string name, Talk talk = Talk::kUsual, Output output = Output::on_stderr());
  ~ProgressLine();  // wipes the line
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const Progress& progress);
  void show(double fraction);
  void show(const std::string& what);

 private:
  double elapsed() const;
  bool due();
  void begin(const std::string& what);
  void print(std::string line) const;

  std::string name_, doing_;
  Talk talk_;
  Output output_;
  Clock::time_point began_, next_;
};

}  // namespace fjr
