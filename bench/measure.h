// What the benchmarks that are programs of their own share.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/nlp/solve_cost.h"

namespace fjr::bench {

using Json = nlohmann::ordered_json;

struct Spread {
  double median, least, largest;
};

inline Spread spread(std::vector<double> values) {
  if (values.empty()) throw std::runtime_error("nothing was measured");
  std::sort(values.begin(), values.end());
  return {values[values.size() / 2], values.front(), values.back()};
}

// Parts of a solve's time, as shares.
inline Json shares(const SolveCost& cost) {
  return {{"evaluation", cost.evaluation / cost.total},
          {"linear_algebra", cost.linear_algebra / cost.total},
          {"ipopt", cost.in_optimiser() / cost.total}};
}

inline void write_json(const std::string& file, const Json& json) {
  if (file.empty()) return;
  if (const auto folder = std::filesystem::path(file).parent_path(); !folder.empty()) {
    std::filesystem::create_directories(folder);
  }
  std::ofstream out(file);
  if (!(out << json.dump(1) << '\n')) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace fjr::bench
