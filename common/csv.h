// Strict reading of CSV files with numbers over time, for trajectories and logs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fjr {

using Metadata = std::map<std::string, std::string>;  // the `# key: value` lines

// Maps our column names to those of the file, if they differ.
using ColumnNames = std::map<std::string, std::string>;

struct CsvRules {
  std::string kind;                              // "trajectory", for messages
  std::vector<std::string> required;             // columns; the first is the time, which increases
  bool (*optional)(std::string_view) = nullptr;  // which further columns are read; all others are ignored
  ColumnNames renamed{};
  std::size_t max_rows = SIZE_MAX;
};

struct CsvTable {
  Metadata metadata;
  std::vector<std::string> names;           // the required columns in their order, then the optional ones in the file's
  std::vector<std::vector<double>> values;  // values[i] belongs to names[i]; at least two rows
};

// Throws InputError naming source, line and column for anything that is not a finite number, for missing and repeated
// columns, for times that do not increase, and for fewer than 2 or more than max_rows rows. The length of lines is
// bounded, so that an endless file is refused early.
CsvTable read_table(std::istream& in, const std::string& source, const CsvRules& rules);

// `# key: value` lines that read back as they were; line ends within become spaces.
std::string format_metadata(const Metadata& metadata);

}  // namespace fjr
