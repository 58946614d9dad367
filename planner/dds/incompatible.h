// Why endpoints of the same topic do not meet.
#pragma once

#include <optional>
#include <string>

#include "planner/dds/participant.h"

namespace fjr::dds {

enum class Side { kReaders, kWriters };

// One sentence on a reader or writer of `topic`, found on the domain, that cannot talk to ours, which is `ours` and of
// type `type`; nothing when there is no such one.
std::optional<std::string> incompatibility(const Participant& participant, Side side, const std::string& topic,
                                           const std::string& type, dds_entity_t ours);

}  // namespace fjr::dds
