#include "planner/dds/executor_states.h"

#include <algorithm>
#include <array>
#include <memory>

#include "planner/dds/wire_execution.h"

namespace fjr::dds {

namespace {

using Endpoint = std::unique_ptr<dds_builtintopic_endpoint_t, decltype(&dds_builtintopic_free_endpoint)>;

// Null: it is gone.
Endpoint endpoint_of(dds_entity_t reader, dds_instance_handle_t writer) {
  return {dds_get_matched_publication_data(reader, writer), dds_builtintopic_free_endpoint};
}

Discovery::Key participant_of(const Endpoint& endpoint) { return std::to_array(endpoint->participant_key.v); }

std::string user_data_of(const Endpoint& endpoint) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(endpoint->qos, &data, &size) || data == nullptr) return "";
  const std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  return text;
}

}  // namespace

ExecutorStates::ExecutorStates(const Participant& participant, const Qos& qos)
    : reader_(participant, participant.handle(), qos) {}

std::vector<ExecutorStates::Heard> ExecutorStates::take() {
  std::vector<Heard> all;
  reader_.take_all([&](const fjr_msg_ExecutorState& message, const dds_sample_info_t& info) {
    if (info.valid_data) all.push_back({info.publication_handle, decode(message)});
  });
  return all;
}

std::optional<Discovery::Key> ExecutorStates::peer(Source source) const {
  const Endpoint writer = endpoint_of(reader_.handle(), source);
  return writer ? std::optional(participant_of(writer)) : std::nullopt;
}

std::vector<Discovery::Key> ExecutorStates::announced(const std::string& robot_id) const {
  std::array<Source, 128> writers{};  // more participants than this are not found on one host (cyclonedds.xml)
  const auto count =
      checked(dds_get_matched_publications(reader_.handle(), writers.data(), writers.size()), "matched publications");
  std::vector<Discovery::Key> keys;
  for (std::size_t i = 0; i < std::min(writers.size(), static_cast<std::size_t>(count)); ++i) {
    const Endpoint writer = endpoint_of(reader_.handle(), writers[i]);
    if (writer && user_data_of(writer) == robot_id) keys.push_back(participant_of(writer));
  }
  return keys;
}

}  // namespace fjr::dds
