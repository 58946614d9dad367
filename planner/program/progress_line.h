// One line on the terminal that is rewritten while something takes its time.
#pragma once

#include <chrono>
#include <string>

#include "planner/plan.h"

namespace fjr {

// Silent unless stderr is a terminal; wiped at the end.
class ProgressLine {
 public:
  explicit ProgressLine(std::string name);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const Progress& progress);
  void show(double fraction);
  void show(const std::string& what);

 private:
  bool due();
  void print(std::string line) const;

  std::string name_;
  bool terminal_;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace fjr
