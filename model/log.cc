#include "model/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <system_error>

#include "model/input_error.h"
#include "model/sha256.h"
#include "model/strict_yaml.h"

namespace fjr {
namespace {

constexpr std::array<std::string_view, 7> kMeasured = {"time", "q1", "q2", "theta1", "theta2", "tau1", "tau2"};
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;  // some hours at 1 kHz

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& source, const ColumnNames& renamed)
      : text_(text), renamed_(renamed) {
    log_.source = source;
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // spreadsheets write this mark
  }

  Log read() {
    while (!text_.empty()) {
      const std::string_view line = trimmed(next_line());
      if (line.empty()) continue;
      if (line.front() == '#') {
        read_comment(line.substr(1));
      } else if (log_.names.empty()) {
        read_header(line);
      } else {
        read_row(line);
      }
    }
    if (log_.names.empty()) throw InputError(log_.source, "", "no header: a log begins with the names of its columns");
    if (log_.rows() < 2) throw InputError(log_.source, "", fmt::format("{} rows; a log has at least 2", log_.rows()));
    return std::move(log_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(log_.source, fmt::format("line {}", line_), problem);
  }
  [[noreturn]] void fail(std::string_view column, const std::string& problem) const {
    throw InputError(log_.source, fmt::format("line {}, column {}", line_, column), problem);
  }

  std::string_view next_line() {
    const std::size_t end = text_.find('\n');
    const std::string_view line = text_.substr(0, end);
    text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
    ++line_;
    return line;
  }

  // Comments without a colon are for people only.
  void read_comment(std::string_view comment) {
    const std::size_t colon = comment.find(':');
    if (colon == std::string_view::npos) return;
    const std::string key(trimmed(comment.substr(0, colon)));
    if (key.empty()) return;
    if (!log_.metadata.emplace(key, trimmed(comment.substr(colon + 1))).second) fail(shown(key) + " is given twice");
  }

  std::string our_name(std::string_view theirs) const {
    for (const auto& [ours, given] : renamed_) {
      if (given == theirs) return ours;
    }
    return std::string(theirs);
  }

  void read_header(std::string_view line) {
    std::set<std::string> seen;
    for (const std::string_view field : split(line)) {
      if (field.empty()) fail("a column without a name");
      const std::string name = our_name(field);
      if (!seen.insert(name).second) fail("column " + shown(name) + " is given twice");
      log_.names.push_back(name);
    }
    for (const auto& [ours, given] : renamed_) {
      if (!seen.contains(ours)) fail(fmt::format("no column {}, which was said to be {}", shown(given), ours));
    }
    for (const std::string_view name : kMeasured) {
      if (!seen.contains(std::string(name))) fail(fmt::format("column {} is missing in {}", name, shown(line)));
    }
    log_.values.resize(log_.names.size());
    time_ = static_cast<std::size_t>(std::find(log_.names.begin(), log_.names.end(), "time") - log_.names.begin());
  }

  void read_row(std::string_view line) {
    const std::vector<std::string_view> fields = split(line);
    if (fields.size() != log_.names.size()) {
      fail(fmt::format("{} fields where the header has {} columns", fields.size(), log_.names.size()));
    }
    const std::vector<double>& times = log_.values[time_];
    const double before = times.empty() ? -HUGE_VAL : times.back();
    for (std::size_t i = 0; i < fields.size(); ++i) log_.values[i].push_back(number(fields[i], log_.names[i]));
    if (!(times.back() > before)) {
      fail("time", fmt::format("{} does not come after {} of the row before", times.back(), before));
    }
  }

  double number(std::string_view field, std::string_view column) const {
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size()) fail(column, shown(field) + " is not a number");
    if (!std::isfinite(value)) fail(column, shown(field) + " is not finite");
    return value;
  }

  std::string_view text_;
  const ColumnNames& renamed_;
  std::size_t line_ = 0;
  std::size_t time_ = 0;
  Log log_;
};

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
  return Reader(text, source, renamed).read();
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
  for (const auto& [key, value] : log.metadata) fmt::format_to(end, "# {}: {}\n", key, value);
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
