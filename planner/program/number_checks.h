// Checks of numbers on the command line. CLI11's own checks accept nan.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <system_error>

namespace fjr {

// Makes a check of a number. holds: condition on the number; what: "from 0 to 10", for messages; named: the check in
// --help.
template <class Holds>
CLI::Validator number_that(Holds holds, const std::string& what, const std::string& named) {
  const auto fault = [holds, what](const std::string& text) {
    double value = 0;
    const bool read = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
    return read && holds(value) ? std::string() : fmt::format("{} is not a number {}", text, what);
  };
  return CLI::Validator(fault, named);
}

inline CLI::Validator between(double least, double most) {
  return number_that([=](double value) { return value >= least && value <= most; },
                     fmt::format("from {} to {}", least, most), fmt::format("FLOAT in [{} - {}]", least, most));
}

inline CLI::Validator positive() {
  return number_that([](double value) { return value > 0; }, "above 0", "POSITIVE");
}

inline CLI::Validator finite() {
  return number_that([](double) { return true; }, "that is finite", "");
}

// CLI11 takes -1 and what is too large for the largest number.
inline CLI::Validator seed() {
  const auto fault = [](const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool read = error == std::errc() && end == text.data() + text.size();
    return read ? std::string() : fmt::format("{} is not a whole number from 0 to 18446744073709551615", text);
  };
  return CLI::Validator(fault, "");
}

inline CLI::Validator not_negative() {
  return number_that([](double value) { return value >= 0; }, "from 0 on", "NONNEGATIVE");
}

}  // namespace fjr
