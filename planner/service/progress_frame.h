// Progress as the payload of a frame.
#pragma once

#include <cstring>
#include <optional>
#include <string>

#include "planner/search/account.h"

namespace fjr {

struct ProgressNumbers {
  double iteration, objective, violation;
};

inline std::string to_payload(const Progress& progress) {
  const ProgressNumbers numbers{static_cast<double>(progress.iteration), progress.objective, progress.violation};
  return std::string(reinterpret_cast<const char*>(&numbers), sizeof numbers) + progress.stage;
}

inline std::optional<Progress> progress_from(const std::string& payload) {
  ProgressNumbers numbers;
  if (payload.size() < sizeof numbers) return std::nullopt;
  std::memcpy(&numbers, payload.data(), sizeof numbers);
  return Progress{payload.substr(sizeof numbers), static_cast<int>(numbers.iteration), numbers.objective,
                  numbers.violation};
}

}  // namespace fjr
