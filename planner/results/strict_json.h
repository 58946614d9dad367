// JSON from a file, as strict as YAML is read.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/input_error.h"

namespace fjr {

// source: what it is called in messages. Throws InputError where it is no JSON, or has a key twice: of two values one
// reader takes the first and another one the last.
nlohmann::ordered_json parse_json(const std::string& text, const std::string& source);

// plan.json in the folder of a plan. Throws InputError, where there is none too.
nlohmann::ordered_json load_plan_json(const std::filesystem::path& folder);

// Returns read(), which takes values of JSON for what fjr plan writes. Throws InputError where they are something else.
template <class Read>
auto reading(const std::string& source, Read&& read) {
  try {
    return read();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(source, "", std::string("is not as fjr plan writes it: ") + error.what());
  }
}

}  // namespace fjr
