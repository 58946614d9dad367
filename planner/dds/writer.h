// A writer of samples of one type.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "planner/dds/entity.h"
#include "planner/dds/participant.h"

namespace fjr::dds {

template <class T>
class Writer {
 public:
  // parent: a participant or a publisher of it.
  Writer(const Participant& participant, dds_entity_t parent, const Qos& qos = TopicOf<T>::qos(),
         const char* topic = TopicOf<T>::kName)
      : topic_(participant.topic<T>(topic)),
        writer_(dds_create_writer(parent, topic_.handle(), qos.get(), nullptr), "writer") {}

  dds_entity_t handle() const { return writer_.handle(); }

  // Returns false if a reader was too slow within the blocking time. The caller keeps the ownership of the sample.
  [[nodiscard]] bool write(const T& sample) {
    const dds_return_t returned = dds_write(writer_.handle(), &sample);
    if (returned == DDS_RETCODE_TIMEOUT) return false;
    checked(returned, TopicOf<T>::kName);
    return true;
  }

  bool has_reader() const { return readers() > 0; }
  std::size_t readers() const {
    dds_publication_matched_status_t status;
    checked(dds_get_publication_matched_status(writer_.handle(), &status), "publication matched");
    return status.current_count;
  }

  // Returns whether a reader of that participant (see Reader::participant_of()) is matched.
  bool has_reader_of(dds_instance_handle_t participant) const {
    return any_reader([&](const dds_builtintopic_endpoint_t& endpoint) {
      return endpoint.participant_instance_handle == participant;
    });
  }

  // Returns whether a reader is matched that acknowledges samples.
  bool has_reliable_reader() const {
    return any_reader([](const dds_builtintopic_endpoint_t& endpoint) {
      dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
      return dds_qget_reliability(endpoint.qos, &kind, nullptr) && kind == DDS_RELIABILITY_RELIABLE;
    });
  }

  // Waits until the readers have everything; false: not within the time.
  bool flush(dds_duration_t timeout) const { return dds_wait_for_acks(writer_.handle(), timeout) == DDS_RETCODE_OK; }

 private:
  template <class Which>
  bool any_reader(Which&& which) const {
    std::array<dds_instance_handle_t, 16> readers{};
    const auto count = static_cast<std::size_t>(
        checked(dds_get_matched_subscriptions(handle(), readers.data(), readers.size()), "matched subscriptions"));
    return std::any_of(readers.begin(), readers.begin() + std::min(count, readers.size()), [&](auto reader) {
      dds_builtintopic_endpoint_t* endpoint = dds_get_matched_subscription_data(handle(), reader);
      if (endpoint == nullptr) return false;
      const bool found = which(*endpoint);
      dds_builtintopic_free_endpoint(endpoint);
      return found;
    });
  }

  Entity topic_;
  Entity writer_;
};

}  // namespace fjr::dds
