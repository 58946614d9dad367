#include "planner/dds/incompatible.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "planner/protocol/printable.h"

namespace fjr::dds {
namespace {

constexpr std::uint32_t kTakenAtOnce = 64;

// Returns the name of a policy; null for the type, which DDS counts among the policies.
const char* policy_name(std::uint32_t id) {
  switch (id) {
    case DDS_DURABILITY_QOS_POLICY_ID:
      return "durability";
    case DDS_DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case DDS_OWNERSHIP_QOS_POLICY_ID:
      return "ownership";
    case DDS_LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    case DDS_RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    case DDS_DATA_REPRESENTATION_QOS_POLICY_ID:
      return "data representation";
    case DDS_PARTITION_QOS_POLICY_ID:
      return "partition";
    case DDS_LATENCYBUDGET_QOS_POLICY_ID:
      return "latency budget";
    case DDS_PRESENTATION_QOS_POLICY_ID:
      return "presentation";
    case DDS_DESTINATIONORDER_QOS_POLICY_ID:
      return "destination order";
    default:
      return nullptr;
  }
}

// Returns the policy because of which the last incompatible endpoint did not match ours.
const char* policy_in_the_way(dds_entity_t ours, Side side) {
  if (side == Side::kReaders) {
    dds_offered_incompatible_qos_status_t status;
    checked(dds_get_offered_incompatible_qos_status(ours, &status), "offered incompatible qos");
    if (status.total_count > 0) return policy_name(status.last_policy_id);
  } else {
    dds_requested_incompatible_qos_status_t status;
    checked(dds_get_requested_incompatible_qos_status(ours, &status), "requested incompatible qos");
    if (status.total_count > 0) return policy_name(status.last_policy_id);
  }
  return nullptr;
}

// Returns the types of all endpoints of the topic that are known on the domain.
std::vector<std::string> types_of(const Participant& participant, Side side, const std::string& topic) {
  const dds_entity_t all =
      side == Side::kReaders ? DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION : DDS_BUILTIN_TOPIC_DCPSPUBLICATION;
  const Entity reader(dds_create_reader(participant.handle(), all, nullptr, nullptr), "built-in topic");
  std::vector<std::string> types;
  for (dds_return_t count = kTakenAtOnce; count == static_cast<dds_return_t>(kTakenAtOnce);) {
    std::array<void*, kTakenAtOnce> samples{};
    std::array<dds_sample_info_t, kTakenAtOnce> infos{};
    count =
        checked(dds_take(reader.handle(), samples.data(), infos.data(), kTakenAtOnce, kTakenAtOnce), "built-in topic");
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      if (infos[i].valid_data && topic == endpoint->topic_name) types.emplace_back(endpoint->type_name);
    }
    if (count > 0) dds_return_loan(reader.handle(), samples.data(), count);
  }
  return types;
}

}  // namespace

std::optional<std::string> incompatibility(const Participant& participant, Side side, const std::string& topic,
                                           const std::string& type, dds_entity_t ours) {
  const char* who = side == Side::kReaders ? "reader" : "writer";
  const std::vector<std::string> types = types_of(participant, side, topic);
  if (types.empty()) return std::nullopt;
  const auto other = std::find_if(types.begin(), types.end(), [&](const std::string& t) { return t != type; });
  if (other != types.end()) {
    return fmt::format("a {} of {} is there, but its type is {} and not {}", who, topic, printable(*other), type);
  }
  if (const char* policy = policy_in_the_way(ours, side)) {
    return fmt::format("a {} of {} is there, but its quality of service does not go with ours ({})", who, topic,
                       policy);
  }
  return fmt::format("a {} of {} is there, but its {} is defined differently: it is of another version", who, topic,
                     type);
}

}  // namespace fjr::dds
