// Where this installation is, whatever program it is linked into.
#pragma once

#include <filesystem>

namespace fjr {

// The folder of the shared library that has this function, and nothing else: the other libraries are static, so their
// own code is in the file of whoever links them, and says nothing about where configuration lies. Empty: not known.
std::filesystem::path library_folder();

}  // namespace fjr
