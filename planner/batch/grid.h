// A grid file (config/batch/reach_grid.yaml): one request and axes along which its values change. Every combination of
// the axes' values is a request of its own.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/strict_yaml.h"

namespace fjr {

inline constexpr std::size_t kMaxGridPoints = 100'000;

struct GridPoint {
  std::string name;             // <grid's name>_<value>_<value>..., so that it depends only on the values
  nlohmann::ordered_json axes;  // path -> value, as in the file
  std::string yaml;             // the request; paths in it are absolute
};

// Returns whether a file is a grid, possibly an incomplete one, and not a request: it has `axes` or `request`.
bool is_grid(const YamlNode& root);

// Returns the points in order, with the first axis changing slowest. Throws InputError naming file, field, value and
// what is allowed for an invalid grid; the requests themselves are not checked here.
std::vector<GridPoint> expand_grid(const YamlNode& root);

// Returns the request as YAML with an absolute path of the robot, so that it can be moved. folder: where its file is.
std::string standing_alone(const YamlNode& request, const std::filesystem::path& folder);

// Returns `count` (at least 1) equidistant values including both ends; a single one is `from`. They are rounded to 12
// digits for readability.
std::vector<double> equidistant(double from, double to, std::size_t count);

}  // namespace fjr
