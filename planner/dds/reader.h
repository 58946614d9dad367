// Taking samples of one type.
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

  // Calls use(sample, info) for everything that is there; without valid data (info.valid_data) only the key is.
  template <class Use>
  void take_all(Use&& use) {
    while (take_some(use) == kMost) {
    }
  }

  // The same for about `most`; what is left keeps arrived() triggered.
  template <class Use>
  void take_at_most(std::size_t most, Use&& use) {
    for (std::size_t taken = 0; taken < most;) {
      const std::size_t some = take_some(use);
      taken += some;
      if (some < kMost) return;
    }
  }

  // The publications that are matched, as in dds_sample_info_t.
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

  // Whose publication it is; nothing: it is gone.
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
  // A loan smaller than an earlier one of the same reader is written beyond its end: there is one size, this one.
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
