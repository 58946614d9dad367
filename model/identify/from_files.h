// Complete identifications, from log files to robot.yaml.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "model/identify/agreement.h"
#include "model/identify/estimate.h"
#include "model/parameters.h"

namespace fjr {

// "stiffness", ...: of all procedures, in the order of section IV.
std::vector<std::string> procedure_names();

struct Identification {
  std::vector<Estimate> estimates;    // of each log
  std::vector<Agreement> agreements;  // between the logs
  std::vector<Change> changes;        // of what was known
};

struct LogFiles {
  std::vector<std::string> files;
  int joint = 0;                                 // 1 or 2; 0: as the logs say
  std::map<std::string, std::string> renamed{};  // our column names -> those of the files, if they differ
};

// Applies one procedure to logs of its experiment. Throws InputError as the procedures do.
Identification identify_logs(const std::string& procedure, const LogFiles& logs, const Parameters& known);

// Applies all procedures to <experiment>_<joint>.csv in a folder, in this order because later ones may need earlier
// results.
Identification identify_folder(const std::string& folder, const std::map<std::string, std::string>& renamed,
                               const Parameters& known);

// Throws InputError if two logs differ by kContradictoryApart or more. Then one of them is wrong, but it is unknown
// which one (for example by a wrong column, unit or file). source: name for the message.
void refuse_contradictions(const Identification& identification, const std::string& source);

// Writes a complete robot.yaml (robot_file.h). Throws InputError for unphysical results; an existing file then stays.
// base: the robot file known so far, and `known` its parameters. Returns the parameters as read back from the written
// file.
Parameters write_robot(const std::filesystem::path& file, const std::filesystem::path& base, const Parameters& known,
                       const Identification& identification, bool use_damping);

}  // namespace fjr
