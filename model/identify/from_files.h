// Whole identifications: from the files of logs to robot.yaml.
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
  std::map<std::string, std::string> renamed{};  // columns of ours -> those of the files, where they differ
};

// One procedure on logs of its experiment. Throws InputError as the procedures do.
Identification identify_logs(const std::string& procedure, const LogFiles& logs, const Parameters& known);

// All of them, in order, on <experiment>_<joint>.csv in a folder: what comes later may need what came before.
Identification identify_folder(const std::string& folder, const std::map<std::string, std::string>& renamed,
                               const Parameters& known);

// Throws InputError where two logs are kContradictoryApart or more apart: one of them is wrong, and nobody knows which:
// a column doubled, another unit, the wrong file. source: what to name.
void refuse_contradictions(const Identification& identification, const std::string& source);

// Writes a complete robot.yaml (robot_file.h). What is unphysical is refused (InputError), and the file that may be
// there already stays. base: what is known so far, `known` of it. Returns what was written, read again.
Parameters write_robot(const std::filesystem::path& file, const std::filesystem::path& base, const Parameters& known,
                       const Identification& identification, bool use_damping);

}  // namespace fjr
