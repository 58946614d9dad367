// The optimiser's solution behind a plan as a file, for warm starts (`fjr plan --warm`): mesh, smoothing, margins,
// variables and multipliers in CBOR (RFC 8949), which keeps every bit of a number.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "planner/ocp/collocate.h"

namespace fjr {

inline constexpr const char* kSolutionFile = "solution.cbor";  // beside trajectory.csv

void write_solution(const std::filesystem::path& file, const Collocated& solution, const std::string& robot_hash);

// Throws InputError naming the file and the problem if it is not such a file or belongs to another robot.
Collocated read_solution(const std::filesystem::path& file, const std::string& robot_hash);

// Convert to and from bytes without a file. source: their origin, for messages.
std::string solution_bytes(const Collocated& solution, const std::string& robot_hash);
Collocated solution_from(std::string_view bytes, const std::string& source, const std::string& robot_hash);

}  // namespace fjr
