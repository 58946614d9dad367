// Readers and writers that credentials made for an earlier version may not permit.
#pragma once

#include <spdlog/spdlog.h>

#include <optional>

#include "planner/dds/participant.h"

namespace fjr::dds {

// One of that participant, or nothing, with a line in the log, where DDS Security does not let it have that topic.
// Endpoint: a Reader or a Writer of a type; qos: what it takes beside its parent.
template <class Endpoint, class... Qos>
std::optional<Endpoint> if_permitted(const Participant& participant, const char* topic, const Qos&... qos) {
  try {
    return Endpoint(participant, participant.handle(), qos...);
  } catch (const Error& error) {
    if (error.code() != DDS_RETCODE_NOT_ALLOWED_BY_SECURITY) throw;
    spdlog::warn("the credentials do not permit {}: make them anew to have it", topic);
    return std::nullopt;
  }
}

}  // namespace fjr::dds
