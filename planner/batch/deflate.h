// Bytes made smaller and back again, in zlib's format: Python's zlib.decompress reads it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fjr {

std::string deflated(std::string_view bytes);
// size: of what was deflated. Throws std::runtime_error where it comes to anything else.
std::string inflated(std::string_view bytes, std::size_t size);

}  // namespace fjr
