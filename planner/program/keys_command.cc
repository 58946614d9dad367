// fjr keys: what a request may say, and what a file of settings may.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "planner/program/commands.h"
#include "planner/request/keys.h"
#include "planner/search/settings_fields.h"
#include "planner/search/settings_file.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

std::string keys_as_json() {
  Json list = Json::array();
  for (const KeyLine& key : all_keys()) {
    list.push_back({{"key", key.name},
                    {"unit", key.unit},
                    {"meaning", key.meaning},
                    {"left_out", key.otherwise},
                    {"allowed", key.allowed}});
  }
  return list.dump(1) + "\n";
}

std::string settings_as_json() {
  const SearchSettings defaults;
  Json list = Json::array();
  visit_all_settings(defaults, [&](const std::string& path, const SettingKey& key, const auto& value) {
    list.push_back({{"key", path}, {"unit", key.unit}, {"default", value}, {"least", key.least}, {"most", key.most}});
  });
  return list.dump(1) + "\n";
}

}  // namespace

void add_keys(CLI::App& app, int& exit_code) {
  const auto json = std::make_shared<bool>(false), settings = std::make_shared<bool>(false);
  CLI::App* command =
      app.add_subcommand("keys", "List every key of a request: unit, meaning, default, what is allowed");
  command->add_flag("--json", *json, "For programs");
  command->add_flag("--settings", *settings,
                    "List the settings of the search instead, as a file for fjr plan --settings");
  command->callback([json, settings, &exit_code] {
    if (*settings) {
      fmt::print("{}", *json ? settings_as_json() : settings_yaml({}));
    } else {
      fmt::print("{}", *json ? keys_as_json() : keys_table());
    }
    exit_code = 0;
  });
}

}  // namespace fjr
