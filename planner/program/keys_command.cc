// fjr keys: what a request may say.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "planner/program/commands.h"
#include "planner/request/keys.h"

namespace fjr {
namespace {

std::string as_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const KeyLine& key : all_keys()) {
    list.push_back({{"key", key.name},
                    {"unit", key.unit},
                    {"meaning", key.meaning},
                    {"left_out", key.otherwise},
                    {"allowed", key.allowed}});
  }
  return list.dump(1) + "\n";
}

}  // namespace

void add_keys(CLI::App& app, int& exit_code) {
  const auto json = std::make_shared<bool>(false);
  CLI::App* command =
      app.add_subcommand("keys", "List every key of a request: unit, meaning, default, what is allowed");
  command->add_flag("--json", *json, "For programs");
  command->callback([json, &exit_code] {
    fmt::print("{}", *json ? as_json() : keys_table());
    exit_code = 0;
  });
}

}  // namespace fjr
