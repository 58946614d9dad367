// The service's writers, one pair per client in the client's own partition. They never block, and exist only for
// clients that listen. Their number is bounded per participant, so that one with many client ids takes no writers from
// others.
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
  kNoRoom,         // the client has not yet received earlier replies
  kNobodyListens,  // no reader in the client's partition
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
  void send(const ProgressReport& report);  // may be lost

  // Sends a reply to standbys only, which remember it.
  void tell_standbys(const Reply& reply);

  bool listens(const RequestId& id) const { return listeners_.any(client_name(id)); }
  dds_entity_t changed() const { return listeners_.changed(); }  // for a waitset
  bool look();  // updates which clients listen; returns whether any has come or gone

  // Returns when the last message to the client was written, if it has acknowledged everything; so it was alive then.
  // Otherwise returns nothing.
  std::optional<Clock::time_point> acknowledged(const RequestId& id) const;

  // Waits until the clients have their replies, but at most for the timeout.
  void flush(std::chrono::nanoseconds timeout) const;

 private:
  struct Client {
    Client(const Participant& participant, const std::string& partition, const Origin& origin = {});

    const Origin origin;  // participant that sent the first answered request
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
