// Places in a request, for messages.
#pragma once

#include <fmt/format.h>

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "common/degrees.h"
#include "common/input_error.h"
#include "planner/request/request.h"

namespace fjr {

// A place in a request, such as "via[2]" of "request.yaml".
struct Place {
  const Request& request;
  std::string field;

  Place at(std::string_view key) const {
    return {request, field.empty() ? std::string(key) : fmt::format("{}.{}", field, key)};
  }
  Place at(std::size_t index) const { return {request, fmt::format("{}[{}]", field, index)}; }
  // Returns the first of `keys` that was given, otherwise this place: it is named if something derived from it is
  // wrong.
  Place first_of(std::initializer_list<std::pair<std::string_view, bool>> keys) const {
    for (const auto& [key, given] : keys) {
      if (given) return at(key);
    }
    return *this;
  }
  [[noreturn]] void fail(const std::string& problem) const { throw InputError(request.source, field, problem); }
};

// Refuses an angle outside [lower, upper] [rad]. The message mentions degrees if the value may have been meant in
// degrees.
inline void check_angle(const Place& place, double angle, double lower, double upper) {
  if (angle >= lower && angle <= upper) return;
  place.fail(fmt::format("{} rad is outside [{}, {}]{}", angle, lower, upper, degrees_suspected(angle, lower, upper)));
}

}  // namespace fjr
