// Options of the command line for planning, which `fjr plan` and `fjr batch` share.
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
void add_report_option(CLI::App& command, PlanSettings& settings);  // for commands that make folders of results

// Returns the options as words of a command line.
std::vector<std::string> to_arguments(const PlanSettings& settings);

}  // namespace fjr
