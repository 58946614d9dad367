// Numbers as they lie in memory within CBOR (RFC 8949): read by the same program on the same kind of machine.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "planner/service/frames.h"

namespace fjr {

template <class T>
nlohmann::json cbor_of(const std::vector<T>& items) {
  const std::string_view bytes = as_payload(items);
  return nlohmann::json::binary({bytes.begin(), bytes.end()});
}

// Throws nlohmann::json::exception where they are no bytes.
template <class T>
std::vector<T> items_in(const nlohmann::json& cbor) {
  const auto& bytes = cbor.get_binary();
  return from_payload<T>({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace fjr
