#include "planner/batch/name_order.h"

#include <charconv>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace fjr {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

struct Part {
  std::optional<double> number;  // none: text
  std::string_view text;

  bool operator<(const Part& other) const {
    if (number && other.number) return *number < *other.number;
    if (number || other.number) return number.has_value();
    return text < other.text;
  }
};

// Returns the number that name.substr(at) begins with, and the length of its text; length 0 if there is none.
std::pair<double, std::size_t> number_at(std::string_view name, std::size_t at) {
  const bool negative = name[at] == '-' && (at == 0 || name[at - 1] == '_');
  const std::size_t first = at + (negative ? 1 : 0);
  if (first == name.size() || !is_digit(name[first])) return {0, 0};
  double number = 0;
  const auto read = std::from_chars(name.data() + at, name.data() + name.size(), number);
  if (read.ec != std::errc()) return {0, 0};  // 1e999
  return {number, static_cast<std::size_t>(read.ptr - (name.data() + at))};
}

// Splits a name into numbers and the single characters between them.
std::vector<Part> parts_of(std::string_view name) {
  std::vector<Part> parts;
  for (std::size_t at = 0; at < name.size();) {
    const auto [number, length] = number_at(name, at);
    if (length > 0) {
      parts.push_back({number, {}});
    } else {
      parts.push_back({{}, name.substr(at, 1)});
    }
    at += length > 0 ? length : 1;
  }
  return parts;
}

}  // namespace

bool comes_before(const std::string& a, const std::string& b) {
  const std::vector<Part> left = parts_of(a), right = parts_of(b);
  if (left < right) return true;
  return !(right < left) && a < b;  // 1 and 1.0
}

}  // namespace fjr
