// Logs of experiments and executions: CSV as in docs/files.md, from the virtual rig or from a real one.
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

  // Number behind a metadata key, or `otherwise` where the key is absent. Throws InputError for anything but a number.
  double number(const std::string& key, double otherwise) const;
};

// "q", 0 -> "q1".
std::string joint_column(std::string_view quantity, int joint, std::string_view suffix = "");

// Reads strictly: InputError names line and column of missing, repeated or malformed columns, of fields that are no
// finite numbers, and of times that do not increase. Any sampling rate; at least 2 rows.
Log read_log(const std::filesystem::path& file, const ColumnNames& renamed = {});
Log parse_log(std::string_view text, const std::string& source, const ColumnNames& renamed = {});

// 12 significant digits.
std::string format_log(const Log& log);

}  // namespace fjr
