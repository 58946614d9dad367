// The version by which instances and workers know each other: of this program. In a file of its own, so that a test can
// link the same program as another version.
#pragma once

#include <string>

namespace fjr {

std::string program_version();

}  // namespace fjr
