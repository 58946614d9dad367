// The service's writers, one pair per client in the client's own partition. None of them ever waits, and there is none
// for whom nobody listens. Their number is bounded for each participant that asks, so that one who uses many ids takes
// no writer from another.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <optional>

#include "planner/dds/listeners.h"
#include "planner/dds/participant.h"
#include "planner/dds/writer.h"
#include "planner/protocol/messages.h"

namespace fjr::dds {

enum class Sent {
  kYes,
  kNoRoom,         // for what the client has not taken yet
  kNobodyListens,  // in the client's partition
};

class ClientWriters {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ClientWriters(const Participant& participant)
      : participant_(participant), listeners_(participant), to_standbys_(participant, "nobody") {}
  ~ClientWriters();
  ClientWriters(const ClientWriters&) = delete;
  ClientWriters& operator=(const ClientWriters&) = delete;

  Sent send(const Reply& reply);
  void send(const ProgressReport& report);  // disposable

  // For standbys alone, which remember what was answered.
  void tell_standbys(const Reply& reply);

  bool listens(const RequestId& id) const { return listeners_.any(client_name(id)); }
  dds_entity_t changed() const { return listeners_.changed(); }  // for a waitset
  bool look();  // takes notice of clients that have come and gone; true: somebody has

  // Nothing: it has not taken everything that was written to it. Otherwise when the last of that was written; it was
  // there at that time.
  std::optional<Clock::time_point> acknowledged(const RequestId& id) const;

  // Waits until the clients have their replies, at most so long.
  void flush(std::chrono::nanoseconds timeout) const;

 private:
  struct Client {
    Client(const Participant& participant, const std::string& partition, const Origin& origin = {});

    const Origin origin;  // whose first request it answered
    Entity publisher;
    Writer<fjr_msg_PlanReply> replies;
    Writer<fjr_msg_PlanStatus> progress;
    std::uint64_t last_used = 0;
    Clock::time_point written;
    bool full = false;
  };
  using Clients = std::map<decltype(RequestId::client), Client>;

  Client* find(const RequestId& id);
  Client* find_or_make(const Reply& reply);
  bool may_make_one_for(const Origin& origin);
  bool make_room_of(const Origin& origin);

  const Participant& participant_;
  Listeners listeners_;
  Clients clients_;
  std::map<Origin, Clock::time_point> full_;  // participants that had no room then
  Client to_standbys_;
  std::uint64_t uses_ = 0;
};

}  // namespace fjr::dds
