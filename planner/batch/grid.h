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
  std::string name;             // <grid's name>_<value>_<value>...: depends on nothing but the values
  nlohmann::ordered_json axes;  // path -> value, as in the file
  std::string yaml;             // the request; paths in it are absolute
};

// Whether a file that was read is a grid, perhaps with something missing, and not a request: it has `axes` or
// `request`.
bool is_grid(const YamlNode& root);

// The points in order, the first axis changing slowest. Throws InputError naming file, field, value and what is allowed
// for a grid that makes no sense; whether the requests do is not asked here.
std::vector<GridPoint> expand_grid(const YamlNode& root);

// A request that means the same wherever its file stands: YAML whose robot is absolute. folder: where it stands now.
std::string standing_alone(const YamlNode& request, const std::filesystem::path& folder);

// `count` equidistant values with both ends, at least 1; of 1 only `from`. To 12 digits, so that they read well.
std::vector<double> equidistant(double from, double to, std::size_t count);

}  // namespace fjr
