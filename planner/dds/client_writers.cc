#include "planner/dds/client_writers.h"

#include <algorithm>
#include <thread>
#include <vector>

#include "planner/dds/wire_reply.h"

namespace fjr::dds {
namespace {

// Writers are kept while their client listens. When a participant has kMostOfOne clients, the least recently used one
// that has received everything loses its writers (they are created again if it returns). If there is none, the
// participant gets no more writers. If many participants have many clients, each may have an equal fraction of
// kMostOfAll instead, so that new participants get writers, too.
constexpr std::size_t kMostOfOne = 128, kMostOfAll = 1024;
constexpr std::chrono::milliseconds kLookAgain{50};  // pause before looking for room again, which takes up to 3 ms

}  // namespace

ClientWriters::Client::Client(const Participant& participant, const std::string& partition, const Origin& of)
    : origin(of),
      publisher(participant.publisher(partition)),
      replies(participant, publisher.handle()),
      progress(participant, publisher.handle()) {}

// Deleting a writer waits up to 1 s for its readers. Those that have to wait are deleted concurrently.
ClientWriters::~ClientWriters() {
  std::vector<std::jthread> waiting;
  for (auto next = clients_.begin(); next != clients_.end();) {
    const auto client = next++;
    if (client->second.replies.flush(0)) continue;
    waiting.emplace_back([node = clients_.extract(client)]() mutable { node = {}; });
  }
}

// Only a writer whose reader has received everything is deleted, because otherwise deleting waits for the reader.
bool ClientWriters::make_room_of(const Origin& origin) {
  auto oldest = clients_.end();
  for (auto client = clients_.begin(); client != clients_.end(); ++client) {
    if (client->second.origin != origin) continue;
    if (oldest != clients_.end() && client->second.last_used > oldest->second.last_used) continue;
    if (client->second.replies.flush(0)) oldest = client;
  }
  if (oldest == clients_.end()) return false;
  clients_.erase(oldest);
  return true;
}

bool ClientWriters::may_make_one_for(const Origin& origin) {
  const auto now = Clock::now();
  std::erase_if(full_, [&](const auto& full) { return now - full.second > kLookAgain; });
  if (full_.contains(origin)) return false;
  std::map<Origin, std::size_t> counts{{origin, 0}};
  for (const auto& [name, client] : clients_) ++counts[client.origin];
  const std::size_t most = std::clamp<std::size_t>(kMostOfAll / counts.size(), 1, kMostOfOne);
  const bool may = counts[origin] < most || make_room_of(origin);
  if (!may) full_[origin] = now;
  return may;
}

ClientWriters::Client* ClientWriters::find(const RequestId& id) {
  const auto found = clients_.find(id.client);
  if (found == clients_.end()) return nullptr;
  found->second.last_used = ++uses_;
  return &found->second;
}

ClientWriters::Client* ClientWriters::find_or_make(const Reply& reply) {
  if (clients_.contains(reply.id.client) || !may_make_one_for(reply.origin)) return find(reply.id);
  clients_.try_emplace(reply.id.client, participant_, client_name(reply.id), reply.origin);
  return find(reply.id);
}

bool ClientWriters::look() {
  if (!listeners_.look()) return false;
  std::erase_if(clients_, [&](const auto& client) { return !listens({client.first, 0}); });
  full_.clear();
  return true;
}

// A client that had no room is tried again only when it has received everything, because each attempt serialises the
// reply.
Sent ClientWriters::send(const Reply& reply) {
  if (!listens(reply.id)) return Sent::kNobodyListens;
  Client* to = find_or_make(reply);
  if (to == nullptr || (to->full && !to->replies.flush(0))) return Sent::kNoRoom;
  to->full = !to->replies.write(encode(reply));
  if (to->full) return Sent::kNoRoom;
  to->written = Clock::now();
  return Sent::kYes;
}

void ClientWriters::send(const ProgressReport& report) {
  if (!listens(report.id)) return;
  if (Client* to = find(report.id)) (void)to->progress.write(encode(report));
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
