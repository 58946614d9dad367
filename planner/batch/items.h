// The requests of a batch.
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
  std::optional<std::string> yaml;  // for a point of a grid: the text to write to that file
  nlohmann::ordered_json axes;      // for a point of a grid: its coordinates; otherwise null
};

// Returns the items from request files, grids, and folders with either (*.yaml, *.yml, without subfolders), ordered by
// name (name_order.h). Requests that cannot be read are included. Throws InputError for a grid that cannot be expanded,
// a folder without requests, and two requests with the same name. folder: of the results, where points of grids get
// their files.
std::vector<BatchItem> collect_items(const std::vector<std::string>& arguments, const std::filesystem::path& folder);

Problem load(const BatchItem& item);  // InputError

// Returns the request as YAML with an absolute path of the robot, so that it can be moved. Throws InputError if it is
// not YAML.
std::string text_of(const BatchItem& item);

// Throws InputError if an item names no robot and the shipped robot.yaml does not exist, so that this is reported once
// and not for every item.
void check_default_robot(const std::vector<BatchItem>& items);

// One of several parts of a batch, whose sizes differ by at most one item. Every item is in exactly one part.
struct Shard {
  std::size_t index = 1, count = 1;  // 1 <= index <= count
};

Shard parse_shard(const std::string& text);  // "2/8"; InputError
std::vector<BatchItem> shard_of(std::vector<BatchItem> items, const Shard& shard);

}  // namespace fjr
