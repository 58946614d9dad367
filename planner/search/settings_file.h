// Files of settings: YAML whose nested keys are those of SearchSettings, such as `continuation: {mesh: {tolerance:
// 1e-6}}`. What a file leaves out keeps its default.
#pragma once

#include <filesystem>
#include <string>

#include "common/strict_yaml.h"
#include "planner/search/settings.h"

namespace fjr {

// Throws InputError with file, key, value and what is allowed: for unknown keys, values outside their bounds, lists of
// another length, and settings that contradict each other.
SearchSettings load_settings(const std::filesystem::path& file);
SearchSettings read_settings(const YamlNode& root);

// Returns a file with all of these settings, which reads back as the same. Comments tell units and bounds.
std::string settings_yaml(const SearchSettings& settings);

}  // namespace fjr
