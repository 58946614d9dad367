// What a batch is to plan.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"

namespace fjr {

struct BatchItem {
  std::string name;               // of the request file, without extension; its results are in the folder of that name
  std::filesystem::path request;  // the file
  std::optional<std::string> yaml;  // of a point of a grid: what is to be written to that file
  nlohmann::ordered_json axes;      // of a point of a grid: its coordinates; otherwise null
};

// From request files, grids and folders with either (*.yaml, *.yml, not in folders below), by name (name_order.h).
// Requests that cannot be read are items too. Throws InputError for a grid that cannot be expanded, a folder without
// requests and two requests of one name. folder: of the results, where points of grids get their files.
std::vector<BatchItem> collect_items(const std::vector<std::string>& arguments, const std::filesystem::path& folder);

Problem load(const BatchItem& item);  // InputError

// The request as YAML that means the same wherever it stands: its robot is absolute. InputError: it is no YAML.
std::string text_of(const BatchItem& item);

// Throws InputError when an item names no robot and the shipped robot.yaml cannot be had: told once, before all of them
// are refused for it.
void check_default_robot(const std::vector<BatchItem>& items);

// One of several equal parts of a batch; every item is in exactly one of them.
struct Shard {
  std::size_t index = 1, count = 1;  // 1 <= index <= count
};

Shard parse_shard(const std::string& text);  // "2/8"; InputError
std::vector<BatchItem> shard_of(std::vector<BatchItem> items, const Shard& shard);

}  // namespace fjr
