#include "planner/dds/listeners.h"

#include <fnmatch.h>

#include <algorithm>
#include <cstring>

namespace fjr::dds {
namespace {

constexpr std::size_t kEndpointsAtOnce = 64;  // one size for all loans

bool reliable(const dds_qos_t* qos) {
  dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
  return dds_qget_reliability(qos, &kind, nullptr) && kind == DDS_RELIABILITY_RELIABLE;
}

std::vector<std::string> partitions_of(const dds_qos_t* qos) {
  std::uint32_t count = 0;
  char** names = nullptr;
  if (!dds_qget_partition(qos, &count, &names)) return {};
  std::vector<std::string> partitions;
  for (std::uint32_t i = 0; i < count; ++i) {
    partitions.emplace_back(names[i]);
    dds_free(names[i]);
  }
  dds_free(static_cast<void*>(names));
  return partitions;
}

bool is_pattern(const std::string& partition) { return partition.find_first_of("*?[") != std::string::npos; }

}  // namespace

Listeners::Listeners(const Participant& participant)
    : reader_(dds_create_reader(participant.handle(), DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
              "built-in topic"),
      changed_(dds_create_readcondition(reader_.handle(), DDS_ANY_STATE), "read condition") {}

bool Listeners::look() {
  bool any = false;
  for (auto count = static_cast<dds_return_t>(kEndpointsAtOnce);
       count == static_cast<dds_return_t>(kEndpointsAtOnce);) {
    std::array<void*, kEndpointsAtOnce> samples{};
    std::array<dds_sample_info_t, kEndpointsAtOnce> infos{};
    count = checked(dds_take(reader_.handle(), samples.data(), infos.data(), kEndpointsAtOnce, kEndpointsAtOnce),
                    "built-in topic");
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      const bool alive = infos[i].valid_data && infos[i].instance_state == DDS_IST_ALIVE;
      if (alive) {
        came(endpoint);
      } else {
        Key key;
        std::copy(std::begin(endpoint.key.v), std::end(endpoint.key.v), key.begin());
        gone(key);
      }
      any = true;
    }
    if (count > 0) dds_return_loan(reader_.handle(), samples.data(), count);
  }
  return any;
}

void Listeners::came(const dds_builtintopic_endpoint_t& endpoint) {
  if (std::strcmp(endpoint.topic_name, TopicOf<fjr_msg_PlanReply>::kName) != 0 || !reliable(endpoint.qos)) return;
  Key key;
  std::copy(std::begin(endpoint.key.v), std::end(endpoint.key.v), key.begin());
  gone(key);
  for (const std::string& partition : partitions_[key] = partitions_of(endpoint.qos)) {
    ++(is_pattern(partition) ? patterns_ : readers_)[partition];
  }
}

void Listeners::gone(const Key& reader) {
  const auto found = partitions_.find(reader);
  if (found == partitions_.end()) return;
  for (const std::string& partition : found->second) {
    auto& readers = is_pattern(partition) ? patterns_ : readers_;
    if (--readers[partition] == 0) readers.erase(partition);
  }
  partitions_.erase(found);
}

bool Listeners::any(const std::string& partition) const {
  return readers_.contains(partition) || std::any_of(patterns_.begin(), patterns_.end(), [&](const auto& pattern) {
           return ::fnmatch(pattern.first.c_str(), partition.c_str(), 0) == 0;
         });
}

}  // namespace fjr::dds
