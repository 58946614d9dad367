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
  std::string library;        // folder of a plan library to start from; empty: none
  std::string settings_file;  // with the settings of the search, plan.search; empty: none
  PlanOptions plan;
};

void add_options(CLI::App& command, PlanSettings& settings);  // all but those below

// For commands that make folders of results.
void add_report_option(CLI::App& command, PlanSettings& settings);

// Adds --settings, which reads the file at once: an InputError comes out of parsing the command line.
void add_settings_option(CLI::App& command, PlanSettings& settings);

// Returns the options as words of a command line.
std::vector<std::string> to_arguments(const PlanSettings& settings);

}  // namespace fjr
