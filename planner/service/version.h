// The version of this program, by which instances and workers recognise each other. It is in a file of its own, so that
// a test can link the same program as another version.
#pragma once

#include <string>

namespace fjr {

std::string program_version();

}  // namespace fjr
