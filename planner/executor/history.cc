#include "planner/executor/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <utility>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/read_file.h"
#include "common/strict_yaml.h"

namespace fjr {
namespace {

constexpr std::size_t kRemembered = 256;
constexpr const char* kUnended = "running";
constexpr std::string_view kEpoch = "epoch ";  // begins the line with it

template <class Number>
bool parse(std::string_view text, Number& number, int base = 10) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  return error == std::errc() && end == text.data() + text.size();
}

std::string_view take_word(std::string_view& line) {
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

// "<client> <number> <code or running> <sentence>"
std::optional<History::Entry> parse_entry(std::string_view line) {
  History::Entry entry;
  const std::string_view client = take_word(line), number = take_word(line), code = take_word(line);
  if (client.size() != 2 * entry.id.client.size() || !parse(number, entry.id.number)) return std::nullopt;
  for (std::size_t i = 0; i < entry.id.client.size(); ++i) {
    if (!parse(client.substr(2 * i, 2), entry.id.client[i], 16)) return std::nullopt;
  }
  if (code != kUnended) {
    std::int32_t value = 0;
    if (!parse(code, value)) return std::nullopt;
    entry.code = static_cast<ResultCode>(value);
  }
  entry.sentence = line;
  return entry;
}

}  // namespace

History::History(std::filesystem::path file) : file_(std::move(file)) {
  std::istringstream in(read_file(file_).value_or(""));
  std::string line;
  for (int number = 1; std::getline(in, line) && number <= 1 << 16; ++number) {
    if (line.starts_with(kEpoch) && parse(std::string_view(line).substr(kEpoch.size()), epoch_)) continue;
    const auto entry = parse_entry(line);
    if (!entry) {
      throw InputError(file_.string(), fmt::format("line {}", number),
                       shown(line) +
                           " is not what an executor remembers of a trajectory; remove the file if it is "
                           "meant for something else, or damaged");
    }
    entries_.push_back(*entry);
  }
}

const History::Entry* History::find(const RequestId& id) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.id == id; });
  return found == entries_.end() ? nullptr : &*found;
}

void History::begin(const RequestId& id, std::uint64_t epoch) {
  History with = *this;
  with.epoch_ = std::max(epoch_, epoch);
  with.entries_.push_back({id, std::nullopt, ""});
  if (with.entries_.size() > kRemembered) with.entries_.pop_front();
  with.write();
  *this = std::move(with);  // not before: what could not be recorded is not run
}

void History::end(const RequestId& id, ResultCode code, const std::string& sentence) {
  for (Entry& entry : entries_) {
    if (entry.id != id) continue;
    entry.code = code;
    entry.sentence = sentence;
  }
  write();
}

void History::write() const {
  std::string text = fmt::format("{}{}\n", kEpoch, epoch_);
  for (const Entry& entry : entries_) {
    std::string sentence = entry.sentence;  // on one line
    std::replace_if(
        sentence.begin(), sentence.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    const std::string code = entry.code ? std::to_string(static_cast<std::int32_t>(*entry.code)) : kUnended;
    text += fmt::format("{} {} {} {}\n", client_name(entry.id), entry.id.number, code, sentence);
  }
  write_file_durably(file_, text);
}

}  // namespace fjr
