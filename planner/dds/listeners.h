// Tracks which clients listen for replies, by the partitions of the reliable readers of fjr/plan_reply. Standbys read
// replies without reliability and do not count.
#pragma once

#include <dds/dds.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "planner/dds/entity.h"
#include "planner/dds/participant.h"

namespace fjr::dds {

class Listeners {
 public:
  explicit Listeners(const Participant& participant);

  dds_entity_t changed() const { return changed_.handle(); }  // for a waitset

  // Updates the readers; returns whether any has come or gone.
  bool look();

  bool any(const std::string& partition) const;  // whether there is a reader in this partition

 private:
  using Key = std::array<std::uint8_t, 16>;

  void came(const dds_builtintopic_endpoint_t& endpoint);
  void gone(const Key& reader);

  Entity reader_, changed_;
  std::map<Key, std::vector<std::string>> partitions_;  // by reader
  std::map<std::string, int> readers_;                  // by partition
  std::map<std::string, int> patterns_;                 // the same, of partitions with * or ?
};

}  // namespace fjr::dds
