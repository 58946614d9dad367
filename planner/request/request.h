// What a user may ask for, read and resolved to numbers.
#pragma once

#include <filesystem>
#include <string>

#include "model/parameters.h"
#include "planner/problem/problem.h"

namespace fjr {

// Reads a request (config/requests/annotated.yaml) and resolves it: presets, defaults, moving starts by flatness,
// limits tightened. Throws InputError naming file, field, value and what is allowed, for malformed and for
// contradictory requests alike (outside limits, static torque too large, free duration without a time weight, ...).
// Nothing is optimised here. default_robot: used when the request names none; empty: the shipped one, looked for only
// then.
Problem load_request(const std::filesystem::path& file, const std::filesystem::path& default_robot = {});

// The same from text; `source` names it in errors, `folder` is what relative paths are relative to.
Problem parse_request(const std::string& yaml, const std::string& source, const std::filesystem::path& folder,
                      const std::filesystem::path& default_robot = {});

// The same for a robot that is known already, from a request that names none.
Problem parse_request(const std::string& yaml, const std::string& source, const Parameters& robot);

}  // namespace fjr
