// What the next repetition of a motion is found from, as the payload of a frame: CBOR (RFC 8949).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planner/protocol/execution_messages.h"

namespace fjr {

struct RunOfMotion {
  std::string motion, run;   // ids in full: that was planned; of the run
  std::string plan_json;     // that went with the rows
  std::vector<Sample> rows;  // that were executed
  std::vector<ExecutedRow> ticks;
  std::uint32_t missed_ticks = 0;
  std::optional<double> refused_fraction;  // of the correction by it, by the executor
};

std::string to_payload(const RunOfMotion& run);
RunOfMotion run_of_motion_from(std::string_view payload);  // throws std::exception where it is none

}  // namespace fjr
