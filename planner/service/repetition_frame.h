// The input for computing the next repetition of a motion, as the payload of a frame in CBOR (RFC 8949).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planner/protocol/execution_messages.h"

namespace fjr {

struct RunOfMotion {
  std::string motion, run;   // full ids of the plan and of the run
  std::string plan_json;     // that went with the rows
  std::vector<Sample> rows;  // that were executed
  std::vector<ExecutedRow> ticks;
  std::uint32_t missed_ticks = 0;
  std::optional<double> refused_fraction;  // fraction of the correction by this run that the executor refused
};

std::string to_payload(const RunOfMotion& run);
RunOfMotion run_of_motion_from(std::string_view payload);  // throws std::exception where it is none

}  // namespace fjr
