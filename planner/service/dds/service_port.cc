#include "planner/service/dds/service_port.h"

#include <algorithm>

#include "planner/service/dds/wire_execution.h"
#include "planner/service/dds/wire_reply.h"
#include "planner/service/dds/wire_request.h"

namespace fjr::dds {
namespace {

// Writers are kept for late replies' sake; the least recently used client makes room, and is met anew when it returns.
constexpr std::size_t kMostClients = 128;

}  // namespace

ServicePort::Client::Client(const Participant& participant, const RequestId& id)
    : publisher(participant.publisher(client_name(id))),
      replies(participant, publisher.handle()),
      progress(participant, publisher.handle()) {}

ServicePort::ServicePort(unsigned domain)
    : participant_(domain),
      waitset_(participant_),
      requests_(participant_, participant_.handle()),
      cancels_(participant_, participant_.handle()),
      status_(participant_, participant_.handle()),
      trajectories_(participant_, participant_.handle()) {
  waitset_.attach(requests_.arrived());
  waitset_.attach(cancels_.arrived());
}

std::vector<Order> ServicePort::take_requests() {
  std::vector<Order> orders;
  requests_.take_all([&](const fjr_msg_PlanRequest& message, const dds_sample_info_t& info) {
    if (info.valid_data) orders.push_back(decode(message));
  });
  return orders;
}

std::vector<RequestId> ServicePort::take_cancels() {
  std::vector<RequestId> ids;
  cancels_.take_all([&](const fjr_msg_PlanCancel& message, const dds_sample_info_t& info) {
    if (info.valid_data) ids.push_back(decode(message.id));
  });
  return ids;
}

ServicePort::Client& ServicePort::client(const RequestId& id) {
  auto found = clients_.find(id.client);
  if (found == clients_.end()) {
    if (clients_.size() >= kMostClients) {
      clients_.erase(std::min_element(clients_.begin(), clients_.end(), [](const auto& a, const auto& b) {
        return a.second.last_used < b.second.last_used;
      }));
    }
    found = clients_.try_emplace(id.client, participant_, id).first;
  }
  found->second.last_used = ++uses_;
  return found->second;
}

bool ServicePort::send(const Reply& reply) { return client(reply.id).replies.write(encode(reply)); }

void ServicePort::send(const ProgressReport& report) {
  (void)client(report.id).progress.write(encode(report));  // disposable
}

void ServicePort::send(const ServiceStatus& status) { (void)status_.write(encode(status)); }

bool ServicePort::send(const TrajectoryOrder& order) { return trajectories_.write(encode(order)); }

void ServicePort::flush(std::chrono::nanoseconds timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (const auto& [key, client] : clients_) {
    const std::chrono::nanoseconds left = end - std::chrono::steady_clock::now();
    if (left.count() <= 0 || !client.replies.flush(left.count())) return;
  }
}

}  // namespace fjr::dds
