#include "planner/dds/senders.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>

#include "planner/dds/entity.h"

namespace fjr::dds {
namespace {

struct FreeEndpoint {
  void operator()(dds_builtintopic_endpoint_t* endpoint) const { dds_builtintopic_free_endpoint(endpoint); }
};

std::optional<Origin> participant_of(dds_entity_t reader, dds_instance_handle_t writer) {
  const std::unique_ptr<dds_builtintopic_endpoint_t, FreeEndpoint> endpoint(
      dds_get_matched_publication_data(reader, writer));
  if (!endpoint) return std::nullopt;
  Origin origin;
  std::copy(std::begin(endpoint->participant_key.v), std::end(endpoint->participant_key.v), origin.begin());
  return origin;
}

Origin of_its_own(dds_instance_handle_t writer) {
  Origin origin{};
  std::memcpy(origin.data(), &writer, sizeof writer);
  return origin;
}

// Returns whether a writer has come or gone since the last call.
bool changed(dds_entity_t reader) {
  dds_subscription_matched_status_t status;
  checked(dds_get_subscription_matched_status(reader, &status), "subscription matched");
  return status.total_count_change != 0 || status.current_count_change != 0;
}

std::vector<dds_instance_handle_t> matched(dds_entity_t reader) {
  std::vector<dds_instance_handle_t> writers(64);
  for (;;) {
    const auto count = static_cast<std::size_t>(
        checked(dds_get_matched_publications(reader, writers.data(), writers.size()), "matched publications"));
    const bool all = count <= writers.size();
    writers.resize(count);
    if (all) return writers;
  }
}

}  // namespace

Origin Senders::origin(dds_entity_t reader, dds_instance_handle_t writer) {
  const auto known = writers_.find(writer);
  if (known != writers_.end()) return known->second;
  const auto participant = participant_of(reader, writer);
  if (!participant) return of_its_own(writer);
  writers_.emplace(writer, *participant);
  present_.insert(*participant);
  return *participant;
}

void Senders::look(const std::vector<dds_entity_t>& readers) {
  // Every reader is queried, because the query resets its status.
  if (std::count_if(readers.begin(), readers.end(), changed) == 0) return;
  std::map<dds_instance_handle_t, Origin> writers;
  present_.clear();
  for (const dds_entity_t reader : readers) {
    for (const dds_instance_handle_t writer : matched(reader)) {
      const auto known = writers_.find(writer);
      const auto origin = known != writers_.end() ? std::optional(known->second) : participant_of(reader, writer);
      if (!origin) continue;
      writers.emplace(writer, *origin);
      present_.insert(*origin);
    }
  }
  writers_ = std::move(writers);
}

}  // namespace fjr::dds
