#include "planner/service/dds/executor_states.h"

#include <algorithm>
#include <memory>

#include "planner/service/dds/wire_execution.h"

namespace fjr::dds {

ExecutorStates::ExecutorStates(const Participant& participant) : reader_(participant, participant.handle()) {}

std::vector<ExecutorStates::Heard> ExecutorStates::take() {
  std::vector<Heard> all;
  reader_.take_all([&](const fjr_msg_ExecutorState& message, const dds_sample_info_t& info) {
    if (info.valid_data) all.push_back({info.publication_handle, decode(message)});
  });
  return all;
}

std::optional<Discovery::Key> ExecutorStates::peer(Source source) const {
  const std::unique_ptr<dds_builtintopic_endpoint_t, decltype(&dds_builtintopic_free_endpoint)> writer(
      dds_get_matched_publication_data(reader_.handle(), source), dds_builtintopic_free_endpoint);
  if (!writer) return std::nullopt;
  Discovery::Key key{};
  std::copy(std::begin(writer->participant_key.v), std::end(writer->participant_key.v), key.begin());
  return key;
}

}  // namespace fjr::dds
