// Logs of experiments and executions, from the virtual rig or a real one, as CSV files described in docs/files.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/csv.h"

namespace fjr {

// Columns `time,q1,q2,theta1,theta2,tau1,tau2`, optional `dtheta1,dtheta2` (the drive's own) and planned values with
// suffix `_plan`; SI units, motor quantities in link coordinates. Other columns are ignored.
struct Log {
  std::string source;  // the file, for messages
  std::string hash;    // SHA-256 of the file's bytes; empty for a log that was never a file
  Metadata metadata;
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;  // values[i] belongs to names[i]; equally long

  std::size_t rows() const { return values.empty() ? 0 : values.front().size(); }
  bool has(std::string_view name) const;
  // Throws InputError naming the missing column.
  const std::vector<double>& column(std::string_view name) const;
  std::vector<double>& column(std::string_view name);

  // Returns the number of a metadata key, or `otherwise` if the key is absent. Throws InputError if it is not a number.
  double number(const std::string& key, double otherwise) const;
};

// "q", 0 -> "q1".
std::string joint_column(std::string_view quantity, int joint, std::string_view suffix = "");

// Reads a log strictly. Throws InputError naming line and column for missing, repeated or malformed columns, for fields
// that are not finite numbers, and for times that do not increase. The sampling rate is arbitrary; at least 2 rows are
// needed.
Log read_log(const std::filesystem::path& file, const ColumnNames& renamed = {});
Log parse_log(std::string_view text, const std::string& source, const ColumnNames& renamed = {});

// Returns the log as CSV with 12 significant digits.
std::string format_log(const Log& log);

}  // namespace fjr
