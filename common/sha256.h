// SHA-256, by which robots and requests are recognised.
#pragma once

#include <string>
#include <string_view>

namespace fjr {

// Returns the hash of the bytes of `text` as 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view text);

}  // namespace fjr
