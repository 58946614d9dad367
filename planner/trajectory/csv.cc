// trajectory.csv: reading strictly, writing reproducibly.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <istream>
#include <optional>
#include <ostream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "model/input_error.h"
#include "planner/trajectory/atomic_file.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

// In the order of Sample: time, the state's eight values, the torque.
constexpr std::array<std::string_view, 1 + kStates + kControls> kColumns = {
    "time", "q1", "q2", "dq1", "dq2", "theta1", "theta2", "dtheta1", "dtheta2", "tau1", "tau2"};

constexpr std::size_t kMaxLineLength = 16384;  // characters
constexpr std::size_t kMaxOtherLines = 4096;   // comments and blank lines: a file is refused early, not read forever

using Values = std::array<double, kColumns.size()>;

Sample to_sample(const Values& values) {
  return {values[0], State<double>::from(&values[1]), {values[1 + kStates], values[2 + kStates]}};
}

Values to_values(const Sample& sample) {
  Values values;
  values[0] = sample.time;
  std::copy_n(sample.state.data(), kStates, &values[1]);
  std::copy_n(sample.torque.data(), kControls, &values[1 + kStates]);
  return values;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// For messages: short, printable, in quotes.
std::string in_quotes(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string start(text.substr(0, kShown));
  for (char& c : start) {
    if (c < ' ' || c > '~') c = '?';
  }
  return "'" + start + (text.size() > kShown ? "...'" : "'");
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
  Reader(std::istream& in, const std::string& source) : in_(in), source_(source), buffer_(kMaxLineLength + 1, '\0') {}

  Trajectory read() {
    while (const auto line = next_line()) {
      if (trimmed(*line).empty()) {
        count_other_line();
      } else if (line->front() == '#') {
        count_other_line();
        read_comment(line->substr(1));
      } else if (columns_ == 0) {
        read_header(*line);
      } else {
        read_row(*line);
      }
    }
    if (columns_ == 0) throw InputError(source_, "", "no header: expected a line " + in_quotes(header()));
    if (result_.samples.size() < 2) {
      throw InputError(source_, "", fmt::format("{} rows; a trajectory has at least 2", result_.samples.size()));
    }
    return std::move(result_);
  }

 private:
  static std::string header() { return fmt::format("{}", fmt::join(kColumns, ",")); }

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(source_, fmt::format("line {}", line_), problem);
  }
  [[noreturn]] void fail(std::string_view column, const std::string& problem) const {
    throw InputError(source_, fmt::format("line {}, column {}", line_, column), problem);
  }

  // The next line without its end, valid until the next call; bounded, so that no file can exhaust the memory.
  std::optional<std::string_view> next_line() {
    in_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    if (in_.bad()) throw InputError(source_, "", fmt::format("cannot be read after line {}", line_));
    auto length = static_cast<std::size_t>(in_.gcount());
    if (in_.eof() && length == 0) return std::nullopt;
    ++line_;
    if (in_.fail() && !in_.eof()) fail(fmt::format("longer than {} characters", kMaxLineLength));
    if (!in_.eof()) --length;  // gcount() counts the end of the line
    std::string_view line(buffer_.data(), length);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);  // spreadsheets write this mark
    return line;
  }

  void count_other_line() {
    if (++other_lines_ > kMaxOtherLines) fail(fmt::format("more than {} comment and blank lines", kMaxOtherLines));
  }

  // Comments without a colon are for people only.
  void read_comment(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return;
    const std::string key(trimmed(text.substr(0, colon)));
    if (key.empty()) return;
    const std::string value(trimmed(text.substr(colon + 1)));
    if (!result_.metadata.emplace(key, value).second) fail(in_quotes(key) + " is given twice");
  }

  void read_header(std::string_view line) {
    const std::vector<std::string_view> names = split(line);
    columns_ = names.size();
    std::set<std::string_view> seen;
    for (const std::string_view column : names) {
      if (column.empty()) fail("a column without a name");
      if (!seen.insert(column).second) fail("column " + in_quotes(column) + " is given twice");
    }
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      const auto found = std::find(names.begin(), names.end(), kColumns[i]);
      if (found == names.end()) fail(fmt::format("column {} is missing in {}", kColumns[i], in_quotes(line)));
      place_[i] = static_cast<std::size_t>(found - names.begin());
    }
  }

  void read_row(std::string_view line) {
    if (result_.samples.size() >= kMaxRows) fail(fmt::format("more than {} rows", kMaxRows));
    const std::vector<std::string_view> fields = split(line);
    if (fields.size() != columns_) {
      fail(fmt::format("{} fields where the header has {} columns", fields.size(), columns_));
    }
    Values values;
    for (std::size_t i = 0; i < kColumns.size(); ++i) values[i] = number(fields[place_[i]], kColumns[i]);
    if (!result_.samples.empty() && !(values[0] > result_.samples.back().time)) {
      fail("time", fmt::format("{} does not come after {} of the row before", values[0], result_.samples.back().time));
    }
    result_.samples.push_back(to_sample(values));
  }

  double number(std::string_view field, std::string_view column) const {
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error == std::errc::invalid_argument || end != field.data() + field.size()) {
      fail(column, in_quotes(field) + " is not a number");
    }
    if (error == std::errc::result_out_of_range) fail(column, in_quotes(field) + " is beyond double precision");
    if (!std::isfinite(value)) fail(column, in_quotes(field) + " is not finite");
    return value;
  }

  std::istream& in_;
  const std::string& source_;
  std::string buffer_;
  std::size_t line_ = 0;
  std::size_t other_lines_ = 0;
  std::size_t columns_ = 0;                           // of the header; 0: not read yet
  std::array<std::size_t, kColumns.size()> place_{};  // of each of kColumns in a row
  Trajectory result_;
};

// A comment is one line, and trimmed when read.
std::string one_line(std::string_view text) {
  std::string line(trimmed(text));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return line;
}

}  // namespace

Trajectory parse_csv(std::istream& in, const std::string& source) { return Reader(in, source).read(); }

Trajectory read_csv(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(file.string(), "", "no such file");
  if (std::filesystem::is_directory(status)) throw InputError(file.string(), "", "is a folder, not a trajectory file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), "", "cannot be opened for reading");
  return parse_csv(in, file.string());
}

void format_csv(const Trajectory& trajectory, std::ostream& out) {
  fmt::memory_buffer text;
  const auto end = std::back_inserter(text);
  for (const auto& [key, value] : trajectory.metadata) {
    fmt::format_to(end, "# {}: {}\n", one_line(key), one_line(value));
  }
  fmt::format_to(end, "{}\n", fmt::join(kColumns, ","));
  for (const Sample& sample : trajectory.samples) {
    const Values values = to_values(sample);
    const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    if (!finite) throw std::invalid_argument(fmt::format("a row near {} s is not finite", sample.time));
    fmt::format_to(end, "{}\n", fmt::join(values, ","));  // the shortest text that reads back to the same bits
  }
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void write_csv(const Trajectory& trajectory, const std::filesystem::path& file) {
  std::ostringstream text;
  format_csv(trajectory, text);
  write_file(file, text.view());
}

}  // namespace fjr
