// Creates readers and writers of topics that credentials for an earlier version may not permit.
#pragma once

#include <spdlog/spdlog.h>

#include <optional>

#include "planner/dds/participant.h"

namespace fjr::dds {

// Returns an endpoint of the participant, or nothing (with a line in the log) if DDS Security does not permit the
// topic. Endpoint: a Reader or a Writer of a type; qos: further arguments of its constructor.
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
