// The persistent form of a reply in CBOR (RFC 8949): what the client was told, and what is needed to execute the
// trajectory. Stop motions are not stored but computed again when needed.
#pragma once

#include <string>
#include <string_view>

#include "planner/protocol/messages.h"

namespace fjr {

std::string to_record(const Reply& reply);

// Throws std::exception if the bytes are not such a record.
Reply from_record(std::string_view record);

}  // namespace fjr
