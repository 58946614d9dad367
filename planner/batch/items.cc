#include "planner/batch/items.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "planner/batch/grid.h"
#include "planner/batch/name_order.h"
#include "planner/request/request.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxShards = 100'000;

// A file that cannot be read counts as a request; the error is reported when it is planned.
std::optional<YamlNode> grid_in(const fs::path& file) {
  try {
    YamlNode root = YamlNode::load(file);
    if (is_grid(root)) return root;
  } catch (const InputError&) {
  }
  return std::nullopt;
}

void add_grid(const YamlNode& root, const fs::path& folder, std::vector<BatchItem>& items) {
  for (GridPoint& point : expand_grid(root)) {
    fs::path file = folder / point.name / (point.name + ".yaml");
    items.push_back({std::move(point.name), std::move(file), std::move(point.yaml), std::move(point.axes)});
  }
}

void add_file(const fs::path& file, const fs::path& folder, std::vector<BatchItem>& items) {
  if (const auto grid = grid_in(file)) return add_grid(*grid, folder, items);
  const std::string name = file.stem().string();
  if (name.empty() || name == "." || name == "..")
    throw InputError("'" + file.string() + "'", "", "is not a request file");
  items.push_back({name, file, std::nullopt, nullptr});
}

std::vector<fs::path> requests_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    const bool yaml = file.extension() == ".yaml" || file.extension() == ".yml";
    if (yaml && !file.filename().string().starts_with('.')) files.push_back(file);
  }
  if (error) throw InputError(folder.string(), "", "cannot be read: " + error.message());
  if (files.empty()) throw InputError(folder.string(), "", "holds no requests (*.yaml, *.yml)");
  return files;
}

// Returns whether the request uses the shipped robot file. One that cannot be read does not.
bool needs_default_robot(const BatchItem& item) {
  try {
    const YamlNode root = item.yaml ? YamlNode::parse(*item.yaml, item.request.string()) : YamlNode::load(item.request);
    return root.is_map() && !root.find("robot");
  } catch (const InputError&) {
    return false;
  }
}

// The summary stands beside the folders.
void refuse_names(const std::vector<BatchItem>& items) {
  for (const BatchItem& item : items) {
    if (item.name.starts_with("summary.")) {
      throw InputError(item.request.string(), "", "names that begin with 'summary.' are those of the summary");
    }
  }
  const auto twice = std::adjacent_find(items.begin(), items.end(),
                                        [](const BatchItem& a, const BatchItem& b) { return a.name == b.name; });
  if (twice == items.end()) return;
  throw InputError(twice->request.string(), "",
                   fmt::format("two requests named '{}' would write the same files; the other one is {}", twice->name,
                               std::next(twice)->request.string()));
}

}  // namespace

std::vector<BatchItem> collect_items(const std::vector<std::string>& arguments, const fs::path& folder) {
  std::vector<BatchItem> items;
  for (const std::string& argument : arguments) {
    std::error_code error;
    if (!fs::is_directory(argument, error)) {
      add_file(argument, folder, items);
      continue;
    }
    for (const fs::path& file : requests_in(argument)) add_file(file, folder, items);
  }
  std::stable_sort(items.begin(), items.end(),
                   [](const BatchItem& a, const BatchItem& b) { return comes_before(a.name, b.name); });
  refuse_names(items);
  return items;
}

std::string text_of(const BatchItem& item) {
  const YamlNode request = item.yaml ? YamlNode::parse(*item.yaml, item.name + ".yaml") : YamlNode::load(item.request);
  return standing_alone(request, fs::absolute(item.request).lexically_normal().parent_path());
}

Problem load(const BatchItem& item) {
  if (!item.yaml) return load_request(item.request);
  return parse_request(*item.yaml, item.request.string(), item.request.parent_path());
}

void check_default_robot(const std::vector<BatchItem>& items) {
  if (std::any_of(items.begin(), items.end(), needs_default_robot)) load_parameters(default_robot_file());
}

Shard parse_shard(const std::string& text) {
  Shard shard{0, 0};
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec == std::errc() && index.ptr != end && *index.ptr == '/') {
    const auto count = std::from_chars(index.ptr + 1, end, shard.count);
    const bool valid = count.ec == std::errc() && count.ptr == end && shard.count <= kMaxShards;
    if (valid && shard.index >= 1 && shard.index <= shard.count) return shard;
  }
  throw InputError("--shard", "",
                   fmt::format("{} is not a part I/N with 1 <= I <= N <= {}, such as 2/8", shown(text), kMaxShards));
}

// The items are dealt out in turn. Neighbours in a grid take similar time, so every part gets some of the long ones.
std::vector<BatchItem> shard_of(std::vector<BatchItem> items, const Shard& shard) {
  std::vector<BatchItem> part;
  for (std::size_t i = shard.index - 1; i < items.size(); i += shard.count) part.push_back(std::move(items[i]));
  return part;
}

}  // namespace fjr
