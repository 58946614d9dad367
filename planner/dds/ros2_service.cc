#include "planner/dds/ros2_service.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace fjr::dds {
namespace {

using MatchedEndpoint = std::unique_ptr<dds_builtintopic_endpoint_t, void (*)(dds_builtintopic_endpoint_t*)>;

constexpr std::size_t kMostClients = 1024;  // largest number of clients of one service that is searched

// Returns the value of `clientid` in "key=value;key=value;"; empty if there is none.
std::string client_id_of(const MatchedEndpoint& endpoint) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(endpoint->qos, &data, &size) || data == nullptr) return "";
  const std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find(';', from), text.size());
    const std::string entry = text.substr(from, end - from);
    if (entry.starts_with("clientid=")) return entry.substr(entry.find('=') + 1);
    from = end + 1;
  }
  return "";
}

}  // namespace

std::string ros2_user_data(const std::string& key, const std::string& id) { return key + "=" + id + ";"; }

CallerPresence presence_of(const Ros2Call& call, dds_entity_t requests, dds_entity_t responses) {
  const MatchedEndpoint writer(dds_get_matched_publication_data(requests, call.writer), dds_builtintopic_free_endpoint);
  if (!writer) return CallerPresence::kGone;
  const std::string id = client_id_of(writer);
  if (id.empty()) return CallerPresence::kReads;
  std::vector<dds_instance_handle_t> readers(kMostClients);
  const auto count = static_cast<std::size_t>(
      checked(dds_get_matched_subscriptions(responses, readers.data(), readers.size()), "matched subscriptions"));
  readers.resize(std::min(count, readers.size()));
  const bool reads = std::any_of(readers.begin(), readers.end(), [&](dds_instance_handle_t handle) {
    const MatchedEndpoint reader(dds_get_matched_subscription_data(responses, handle), dds_builtintopic_free_endpoint);
    return reader && client_id_of(reader) == id;
  });
  return reads ? CallerPresence::kReads : CallerPresence::kMayComeToRead;
}

}  // namespace fjr::dds
