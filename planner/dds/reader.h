// A reader that takes samples of one type.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "planner/dds/entity.h"
#include "planner/dds/participant.h"

namespace fjr::dds {

template <class T>
class Reader {
 public:
  // parent: a participant or a subscriber of it.
  Reader(const Participant& participant, dds_entity_t parent, const Qos& qos = TopicOf<T>::qos(),
         const char* topic = TopicOf<T>::kName)
      : topic_(participant.topic<T>(topic)),
        reader_(dds_create_reader(parent, topic_.handle(), qos.get(), nullptr), "reader"),
        arrived_(dds_create_readcondition(reader_.handle(), DDS_ANY_STATE), "read condition") {}

  dds_entity_t handle() const { return reader_.handle(); }
  dds_entity_t arrived() const { return arrived_.handle(); }  // for a waitset

  // Calls use(sample, info) for every sample. If info.valid_data is false, only the key fields are set.
  template <class Use>
  void take_all(Use&& use) {
    while (take_some(use) == kMost) {
    }
  }

  // Calls use(sample, info) for about `most` samples; while some are left, arrived() stays triggered.
  template <class Use>
  void take_at_most(std::size_t most, Use&& use) {
    for (std::size_t taken = 0; taken < most;) {
      const std::size_t some = take_some(use);
      taken += some;
      if (some < kMost) return;
    }
  }

  // Returns the handles of matched publications, as in dds_sample_info_t.
  std::vector<dds_instance_handle_t> writers() const {
    std::vector<dds_instance_handle_t> handles(16);
    for (;;) {
      const auto count = static_cast<std::size_t>(
          checked(dds_get_matched_publications(reader_.handle(), handles.data(), handles.size()), "publications"));
      const bool all = count <= handles.size();
      handles.resize(count);
      if (all) return handles;
    }
  }

  // Returns the participant of a publication, or nothing if it is gone.
  std::optional<dds_instance_handle_t> participant_of(dds_instance_handle_t publication) const {
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader_.handle(), publication);
    if (endpoint == nullptr) return std::nullopt;
    const dds_instance_handle_t participant = endpoint->participant_instance_handle;
    dds_builtintopic_free_endpoint(endpoint);
    return participant;
  }

  bool has_writer() const {
    dds_subscription_matched_status_t status;
    checked(dds_get_subscription_matched_status(reader_.handle(), &status), "subscription matched");
    return status.current_count > 0;
  }

 private:
  // All loans have the same size, because Cyclone DDS writes beyond the end of a loan that is smaller than an earlier
  // one of the same reader.
  static constexpr std::size_t kMost = 16;

  struct Loan {
    explicit Loan(dds_entity_t from) : reader(from) {
      count = checked(dds_take(reader, samples.data(), infos.data(), kMost, kMost), "take");
    }
    ~Loan() {
      if (count > 0) dds_return_loan(reader, samples.data(), count);
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

    dds_entity_t reader;
    std::array<void*, kMost> samples{};  // null: lend them
    std::array<dds_sample_info_t, kMost> infos{};
    dds_return_t count = 0;
  };

  template <class Use>
  std::size_t take_some(Use&& use) {
    const Loan loan(reader_.handle());
    const auto count = static_cast<std::size_t>(loan.count);
    for (std::size_t i = 0; i < count; ++i) use(*static_cast<const T*>(loan.samples[i]), loan.infos[i]);
    return count;
  }

  Entity topic_;
  Entity reader_;
  Entity arrived_;
};

}  // namespace fjr::dds
