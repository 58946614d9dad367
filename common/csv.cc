#include "common/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <istream>
#include <iterator>
#include <optional>
#include <set>
#include <system_error>

#include "common/input_error.h"

namespace fjr {
namespace {

constexpr std::size_t kMaxLineLength = 16384;  // characters
constexpr const char* kRows = "rows";          // header key for the number of rows, to detect truncated files
constexpr const char* kNotMeant = " (another column was named)";
constexpr std::size_t kMaxOtherLines = 4096;  // comments and blank lines, so that an endless file is refused early

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

void split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

class Reader {
 public:
  Reader(std::istream& in, const std::string& source, const CsvRules& rules)
      : in_(in), source_(source), rules_(rules), buffer_(kMaxLineLength + 1, '\0') {}

  CsvTable read() {
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
    if (ended_ && table_.metadata.contains(kRows)) fail("does not end: the file was cut short");
    if (columns_ == 0) throw InputError(source_, "", "no header: expected a line " + in_quotes(header()));
    const std::size_t rows = table_.values.front().size();
    if (rows < 2) throw InputError(source_, "", fmt::format("{} rows; a {} has at least 2", rows, rules_.kind));
    return std::move(table_);
  }

 private:
  std::string header() const { return fmt::format("{}", fmt::join(rules_.required, ",")); }

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
    ended_ = in_.eof();
    if (!ended_) --length;  // gcount() counts the end of the line
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
    if (!table_.metadata.emplace(key, value).second) fail(in_quotes(key) + " is given twice");
  }

  std::string our_name(std::string_view theirs) const {
    for (const auto& [ours, given] : rules_.renamed) {
      if (given == theirs) return ours;
    }
    return std::string(theirs) + (rules_.renamed.contains(std::string(theirs)) ? kNotMeant : "");
  }

  std::vector<std::string> names_in(std::string_view line) {
    split(line, fields_);
    std::vector<std::string> names;
    std::set<std::string> seen;
    for (const std::string_view field : fields_) {
      if (field.empty()) fail("a column without a name");
      names.push_back(our_name(field));
      if (!seen.insert(names.back()).second) fail("column " + in_quotes(names.back()) + " is given twice");
    }
    for (const auto& [ours, given] : rules_.renamed) {
      if (!seen.contains(ours)) fail(fmt::format("no column {}, which was said to be {}", in_quotes(given), ours));
    }
    return names;
  }

  void take_column(const std::string& name, std::size_t place) {
    table_.names.push_back(name);
    place_.push_back(place);
  }

  void read_header(std::string_view line) {
    const std::vector<std::string> names = names_in(line);
    columns_ = names.size();
    for (const std::string& column : rules_.required) {
      const auto found = std::find(names.begin(), names.end(), column);
      if (found == names.end()) fail(fmt::format("column {} is missing in {}", column, in_quotes(line)));
      take_column(column, static_cast<std::size_t>(found - names.begin()));
    }
    for (std::size_t i = 0; i < names.size() && rules_.optional; ++i) {
      const bool taken = std::find(table_.names.begin(), table_.names.end(), names[i]) != table_.names.end();
      if (!taken && rules_.optional(names[i])) take_column(names[i], i);
    }
    table_.values.resize(table_.names.size());
  }

  void read_row(std::string_view line) {
    const std::vector<double>& times = table_.values.front();
    if (times.size() >= rules_.max_rows) fail(fmt::format("more than {} rows", rules_.max_rows));
    split(line, fields_);
    if (fields_.size() != columns_) {
      fail(fmt::format("{} fields where the header has {} columns", fields_.size(), columns_));
    }
    for (std::size_t i = 0; i < place_.size(); ++i) {
      table_.values[i].push_back(number(fields_[place_[i]], table_.names[i]));
    }
    if (times.size() > 1 && !(times.back() > times[times.size() - 2])) {
      fail(table_.names.front(),
           fmt::format("{} does not come after {} of the row before", times.back(), times[times.size() - 2]));
    }
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

  bool ended_ = false;  // the last line that was read has no end
  std::istream& in_;
  const std::string& source_;
  const CsvRules& rules_;
  std::string buffer_;
  std::vector<std::string_view> fields_;  // of the line
  std::size_t line_ = 0;
  std::size_t other_lines_ = 0;
  std::size_t columns_ = 0;         // of the header; 0: not read yet
  std::vector<std::size_t> place_;  // in a row, of each column of the table
  CsvTable table_;
};

// A comment is one line, and trimmed when read.
std::string one_line(std::string_view text) {
  std::string line(trimmed(text));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return line;
}

}  // namespace

CsvTable read_table(std::istream& in, const std::string& source, const CsvRules& rules) {
  return Reader(in, source, rules).read();
}

std::string format_metadata(const Metadata& metadata) {
  std::string text;
  for (const auto& [key, value] : metadata) text += fmt::format("# {}: {}\n", one_line(key), one_line(value));
  return text;
}

}  // namespace fjr
