#include "planner/service/dds/client_writers.h"

#include "planner/service/dds/wire_reply.h"

namespace fjr::dds {
namespace {

// Writers are kept for late replies' sake. Beyond the first number the least recently used client that is gone or has
// everything makes room, and is met anew when it returns; the second is never exceeded.
constexpr std::size_t kUsualClients = 128, kMostClients = 1024;

// What is written before the client's reader is known is kept for it as for any late joiner, the last few only: on a
// busy machine a flood of replies would be lost. A client that does not show itself for longer is gone, or comes late.
constexpr std::chrono::seconds kMeeting{2};

}  // namespace

ClientWriters::Client::Client(const Participant& participant, const RequestId& id)
    : publisher(participant.publisher(client_name(id))),
      replies(participant, publisher.handle()),
      progress(participant, publisher.handle()) {}

// Deleting a writer whose reader lacks something would wait for the reader.
void ClientWriters::make_room() {
  auto oldest = clients_.end();
  for (auto client = clients_.begin(); client != clients_.end(); ++client) {
    if (oldest != clients_.end() && client->second.last_used > oldest->second.last_used) continue;
    if (!client->second.replies.has_reader() || client->second.replies.flush(0)) oldest = client;
  }
  if (oldest != clients_.end()) clients_.erase(oldest);
}

ClientWriters::Client* ClientWriters::client(const RequestId& id) {
  auto found = clients_.find(id.client);
  if (found == clients_.end()) {
    if (clients_.size() >= kUsualClients) make_room();
    if (clients_.size() >= kMostClients) return nullptr;
    found = clients_.try_emplace(id.client, participant_, id).first;
  }
  found->second.last_used = ++uses_;
  return &found->second;
}

// One that was full is tried again only when it has taken everything: trying means serialising.
bool ClientWriters::send(const Reply& reply) {
  Client* to = client(reply.id);
  if (to == nullptr || (to->full && !to->replies.flush(0))) return false;
  if (!to->replies.has_reader() && std::chrono::steady_clock::now() - to->met < kMeeting) return false;
  to->full = !to->replies.write(encode(reply));
  return !to->full;
}

void ClientWriters::send(const ProgressReport& report) {
  if (Client* to = client(report.id)) (void)to->progress.write(encode(report));
}

void ClientWriters::flush(std::chrono::nanoseconds timeout) const {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (const auto& [key, client] : clients_) {
    const std::chrono::nanoseconds left = end - std::chrono::steady_clock::now();
    if (left.count() <= 0 || !client.replies.flush(left.count())) return;
  }
}

}  // namespace fjr::dds
