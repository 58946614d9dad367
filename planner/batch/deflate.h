// Compression in zlib's format, which Python's zlib.decompress reads.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fjr {

std::string deflated(std::string_view bytes);
// size: number of bytes before compression. Throws std::runtime_error if the result has another size.
std::string inflated(std::string_view bytes, std::size_t size);

}  // namespace fjr
