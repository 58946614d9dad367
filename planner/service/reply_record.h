// A reply as bytes that outlive the process, in CBOR (RFC 8949): what its client was told, and what it takes to have
// its trajectory executed. Its stop motions are found again where they are needed.
#pragma once

#include <string>
#include <string_view>

#include "planner/protocol/messages.h"

namespace fjr {

std::string to_record(const Reply& reply);

// Throws std::exception where the bytes are no such record.
Reply from_record(std::string_view record);

}  // namespace fjr
