// Counts the requests of a batch by their status.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace fjr {

// Statuses in addition to those of plans (planner/plan.h):
inline constexpr const char* kFailedStatus = "failed";  // the planning process crashed, or could not plan
inline constexpr const char* kOpenStatus = "open";      // not planned yet

class StatusCounts {
 public:
  void add(const std::string& status) { ++counts_[status]; }
  std::size_t of(const std::string& status) const;

  nlohmann::ordered_json to_json() const;  // of those that occur, certified first
  std::string for_people() const;          // a line each
  int exit_code() const;                   // the largest of all; open requests count like a deadline

 private:
  template <class Visit>
  void each(const Visit& visit) const;

  std::map<std::string, std::size_t> counts_;
};

}  // namespace fjr
