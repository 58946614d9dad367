// A participant in a DDS domain, from which all other entities are created.
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

// Applies the shipped loopback configuration unless CYCLONEDDS_URI is set. With credentials (credentials.h), only
// participants with credentials of the same authorities are discovered.
class Participant {
 public:
  explicit Participant(unsigned domain, const std::filesystem::path& credentials = credentials_from_environment());

  dds_entity_t handle() const { return participant_.handle(); }
  bool secured() const { return secured_; }  // takes part with credentials

  // name: of the topic, if it is not the same for all topics of this type.
  template <class T>
  Entity topic(const char* name = TopicOf<T>::kName) const {
    using Topic = TopicOf<T>;
    return Entity(dds_create_topic(handle(), Topic::descriptor(), name, Topic::qos().get(), nullptr), name);
  }

  // Return a publisher or subscriber whose writers or readers only match within the partition.
  Entity publisher(const std::string& partition) const {
    return Entity(dds_create_publisher(handle(), Qos().partition(partition).get(), nullptr), "publisher");
  }
  Entity subscriber(const std::string& partition) const {
    return Entity(dds_create_subscriber(handle(), Qos().partition(partition).get(), nullptr), "subscriber");
  }

 private:
  struct Opening;
  Participant(unsigned domain, const std::filesystem::path& credentials, const Opening& opening);

  bool secured_;
  std::shared_ptr<Entity> domain_;  // none: CYCLONEDDS_URI configures it
  Entity participant_;
};

// Returns the participant for programs that move or stop an arm, directly or by requests. Throws InputError if
// anonymous participants on the network could do so as well, unless that is allowed explicitly.
Participant guarded_participant(const Network& network);

}  // namespace fjr::dds
