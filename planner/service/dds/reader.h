// Taking samples of one type.
#pragma once

#include <array>
#include <cstddef>

#include "planner/service/dds/entity.h"
#include "planner/service/dds/participant.h"

namespace fjr::dds {

template <class T>
class Reader {
 public:
  // parent: a participant or a subscriber of it.
  Reader(const Participant& participant, dds_entity_t parent)
      : topic_(participant.topic<T>()),
        reader_(dds_create_reader(parent, topic_.handle(), TopicOf<T>::qos().get(), nullptr), "reader"),
        arrived_(dds_create_readcondition(reader_.handle(), DDS_ANY_STATE), "read condition") {}

  dds_entity_t handle() const { return reader_.handle(); }
  dds_entity_t arrived() const { return arrived_.handle(); }  // for a waitset

  // Calls use(sample, info) for everything that is there; without valid data (info.valid_data) only the key is.
  template <class Use>
  void take_all(Use&& use) {
    while (take_some(use) == kMost) {
    }
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
