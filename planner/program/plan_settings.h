// How requests are planned, from the command line: the options that `fjr plan` and `fjr batch` share.
#pragma once

#include <string>
#include <vector>

#include "planner/plan.h"

namespace CLI {
class App;
}

namespace fjr {

struct PlanSettings {
  bool keep_uncertified = false;
  bool report = false;
  std::string library;  // folder of a plan library to start from; empty: none
  PlanOptions plan;
};

void add_options(CLI::App& command, PlanSettings& settings);        // all but --report
void add_report_option(CLI::App& command, PlanSettings& settings);  // of commands that make folders of results

// The options again as words of a command line.
std::vector<std::string> to_arguments(const PlanSettings& settings);

}  // namespace fjr
