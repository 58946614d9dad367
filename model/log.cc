#include "model/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>

#include "common/input_error.h"
#include "common/sha256.h"
#include "common/strict_yaml.h"

namespace fjr {
namespace {

constexpr std::array<std::string_view, 7> kMeasured = {"time", "q1", "q2", "theta1", "theta2", "tau1", "tau2"};
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;  // some hours at 1 kHz

bool is_optional(std::string_view column) {
  return column == "dtheta1" || column == "dtheta2" || column.ends_with("_plan");
}

std::string contents(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file.string(), "", "no such file");
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(file.string(), "", "is not a log file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error || size > kMaxBytes) throw InputError(file.string(), "", "cannot be read, or is larger than 1 GiB");
  std::ifstream in(file, std::ios::binary);
  std::string text(size, '\0');
  in.read(text.data(), static_cast<std::streamsize>(size));
  if (!in) throw InputError(file.string(), "", "cannot be read");
  return text;
}

std::size_t index_of(const Log& log, std::string_view name) {
  const auto found = std::find(log.names.begin(), log.names.end(), name);
  if (found == log.names.end()) throw InputError(log.source, std::string(name), "this column is needed and missing");
  return static_cast<std::size_t>(found - log.names.begin());
}

}  // namespace

bool Log::has(std::string_view name) const { return std::find(names.begin(), names.end(), name) != names.end(); }
const std::vector<double>& Log::column(std::string_view name) const { return values[index_of(*this, name)]; }
std::vector<double>& Log::column(std::string_view name) { return values[index_of(*this, name)]; }

double Log::number(const std::string& key, double otherwise) const {
  const auto found = metadata.find(key);
  if (found == metadata.end()) return otherwise;
  const std::string& text = found->second;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw InputError(source, "# " + key, shown(text) + " is not a number");
  }
  return value;
}

std::string joint_column(std::string_view quantity, int joint, std::string_view suffix) {
  return fmt::format("{}{}{}", quantity, joint + 1, suffix);
}

Log parse_log(std::string_view text, const std::string& source, const ColumnNames& renamed) {
  std::istringstream in{std::string(text)};
  CsvTable table = read_table(in, source, {"log", {kMeasured.begin(), kMeasured.end()}, is_optional, renamed});
  return {source, "", std::move(table.metadata), std::move(table.names), std::move(table.values)};
}

Log read_log(const std::filesystem::path& file, const ColumnNames& renamed) {
  const std::string text = contents(file);
  Log log = parse_log(text, file.string(), renamed);
  log.hash = sha256_hex(text);
  return log;
}

std::string format_log(const Log& log) {
  fmt::memory_buffer text;
  const auto end = std::back_inserter(text);
  fmt::format_to(end, "{}", format_metadata(log.metadata));
  fmt::format_to(end, "{}\n", fmt::join(log.names, ","));
  for (std::size_t row = 0; row < log.rows(); ++row) {
    for (std::size_t i = 0; i < log.values.size(); ++i) {
      fmt::format_to(end, "{}{:.12g}", i == 0 ? "" : ",", log.values[i][row]);
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

}  // namespace fjr
