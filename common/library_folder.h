// Finds the folder of this installation, whatever program it is linked into.
#pragma once

#include <filesystem>

namespace fjr {

// Returns the folder of the shared library that contains only this function; empty if it is unknown. The other
// libraries are static, so their code may be in any program and does not show where the configuration is.
std::filesystem::path library_folder();

}  // namespace fjr
