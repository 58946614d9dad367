// Reads JSON as strictly as YAML is read.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/input_error.h"

namespace fjr {

// source: its name in messages. Throws InputError if the text is not JSON, or if a key occurs twice, because then some
// readers would use the first value and others the last.
nlohmann::ordered_json parse_json(const std::string& text, const std::string& source);

// Reads plan.json in the folder of a plan. Throws InputError, also if it does not exist.
nlohmann::ordered_json load_plan_json(const std::filesystem::path& folder);

// Returns read(), which assumes JSON as `fjr plan` writes it. Throws InputError if values have other types.
template <class Read>
auto reading(const std::string& source, Read&& read) {
  try {
    return read();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(source, "", std::string("is not as fjr plan writes it: ") + error.what());
  }
}

}  // namespace fjr
