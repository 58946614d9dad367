// Units of the limits named in requests and reports, for people.
#pragma once

#include <string_view>

namespace fjr {

std::string_view unit_of_limit(std::string_view name);  // "torque" -> "N m"

}  // namespace fjr
