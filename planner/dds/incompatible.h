// Explains why endpoints of the same topic do not match.
#pragma once

#include <optional>
#include <string>

#include "planner/dds/participant.h"

namespace fjr::dds {

enum class Side { kReaders, kWriters };

// Returns a sentence about a reader or writer of `topic` on the domain that does not match our endpoint `ours` of type
// `type`, or nothing if there is none.
std::optional<std::string> incompatibility(const Participant& participant, Side side, const std::string& topic,
                                           const std::string& type, dds_entity_t ours);

}  // namespace fjr::dds
