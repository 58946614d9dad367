// Taking part in a DDS domain, and what everything else is made from.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "planner/dds/credentials.h"
#include "planner/dds/entity.h"
#include "planner/dds/qos.h"
#include "planner/dds/topics.h"
#include "planner/protocol/network.h"

namespace fjr::dds {

// Applies the shipped loopback configuration unless CYCLONEDDS_URI says otherwise. With credentials (credentials.h)
// only participants with credentials of the same authorities are met.
class Participant {
 public:
  explicit Participant(unsigned domain, const std::filesystem::path& credentials = credentials_from_environment());

  dds_entity_t handle() const { return participant_.handle(); }
  bool secured() const { return secured_; }  // takes part with credentials

  // name: where it is not the same for all.
  template <class T>
  Entity topic(const char* name = TopicOf<T>::kName) const {
    using Topic = TopicOf<T>;
    return Entity(dds_create_topic(handle(), Topic::descriptor(), name, Topic::qos().get(), nullptr), name);
  }

  // Groups: readers and writers made from these only meet within the partition.
  Entity publisher(const std::string& partition) const {
    return Entity(dds_create_publisher(handle(), Qos().partition(partition).get(), nullptr), "publisher");
  }
  Entity subscriber(const std::string& partition) const {
    return Entity(dds_create_subscriber(handle(), Qos().partition(partition).get(), nullptr), "subscriber");
  }

 private:
  bool secured_;
  std::shared_ptr<Entity> domain_;  // none: CYCLONEDDS_URI configures it
  Entity participant_;
};

// For every program that moves or stops an arm, or has it moved or stopped: throws InputError when others on a network
// could do so without saying who they are, unless that is allowed.
Participant guarded_participant(const Network& network);

}  // namespace fjr::dds
