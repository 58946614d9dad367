#include "planner/dds/client_writers.h"

#include "planner/dds/wire_reply.h"

namespace fjr::dds {
namespace {

// Writers are kept while somebody listens. Beyond the first number the least recently used client that has everything
// makes room, and is met anew when it returns; the second is never exceeded.
constexpr std::size_t kUsualClients = 128, kMostClients = 1024;

}  // namespace

ClientWriters::Client::Client(const Participant& participant, const std::string& partition)
    : publisher(participant.publisher(partition)),
      replies(participant, publisher.handle()),
      progress(participant, publisher.handle()) {}

// Deleting a writer whose reader lacks something would wait for the reader.
void ClientWriters::make_room() {
  auto oldest = clients_.end();
  for (auto client = clients_.begin(); client != clients_.end(); ++client) {
    if (oldest != clients_.end() && client->second.last_used > oldest->second.last_used) continue;
    if (client->second.replies.flush(0)) oldest = client;
  }
  if (oldest != clients_.end()) clients_.erase(oldest);
}

ClientWriters::Client* ClientWriters::client(const RequestId& id) {
  auto found = clients_.find(id.client);
  if (found == clients_.end()) {
    if (clients_.size() >= kUsualClients) make_room();
    if (clients_.size() >= kMostClients) return nullptr;
    found = clients_.try_emplace(id.client, participant_, client_name(id)).first;
  }
  found->second.last_used = ++uses_;
  return &found->second;
}

bool ClientWriters::look() {
  if (!listeners_.look()) return false;
  std::erase_if(clients_, [&](const auto& client) { return !listens({client.first, 0}); });
  return true;
}

// One that was full is tried again only when it has taken everything: trying means serialising.
Sent ClientWriters::send(const Reply& reply) {
  if (!listens(reply.id)) return Sent::kNobodyListens;
  Client* to = client(reply.id);
  if (to == nullptr || (to->full && !to->replies.flush(0))) return Sent::kNoRoom;
  to->full = !to->replies.write(encode(reply));
  if (to->full) return Sent::kNoRoom;
  to->written = Clock::now();
  return Sent::kYes;
}

void ClientWriters::send(const ProgressReport& report) {
  if (!listens(report.id)) return;
  if (Client* to = client(report.id)) (void)to->progress.write(encode(report));
}

void ClientWriters::tell_standbys(const Reply& reply) {
  if (to_standbys_.replies.has_reader()) (void)to_standbys_.replies.write(encode(reply));
}

std::optional<ClientWriters::Clock::time_point> ClientWriters::acknowledged(const RequestId& id) const {
  const auto found = clients_.find(id.client);
  if (found == clients_.end()) return std::nullopt;
  const Client& client = found->second;
  if (!client.replies.has_reliable_reader() || !client.replies.flush(0)) return std::nullopt;
  return client.written;
}

void ClientWriters::flush(std::chrono::nanoseconds timeout) const {
  const auto end = Clock::now() + timeout;
  for (const auto& [key, client] : clients_) {
    const std::chrono::nanoseconds left = end - Clock::now();
    if (left.count() <= 0 || !client.replies.flush(left.count())) return;
  }
}

}  // namespace fjr::dds
