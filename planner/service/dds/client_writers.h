// The service's writers, one pair per client in the client's own partition. None of them ever waits.
#pragma once

#include <array>
#include <chrono>
#include <map>

#include "planner/service/dds/participant.h"
#include "planner/service/dds/writer.h"
#include "planner/service/messages.h"

namespace fjr::dds {

class ClientWriters {
 public:
  explicit ClientWriters(const Participant& participant) : participant_(participant) {}

  bool send(const Reply& reply);            // false: no room yet for what the client has not taken
  void send(const ProgressReport& report);  // disposable

  // Waits until the clients have their replies, at most so long.
  void flush(std::chrono::nanoseconds timeout) const;

 private:
  struct Client {
    Client(const Participant& participant, const RequestId& id);

    Entity publisher;
    Writer<fjr_msg_PlanReply> replies;
    Writer<fjr_msg_PlanStatus> progress;
    std::uint64_t last_used = 0;
    std::chrono::steady_clock::time_point met = std::chrono::steady_clock::now();
    bool full = false;
  };
  using Clients = std::map<decltype(RequestId::client), Client>;

  Client* client(const RequestId& id);
  void make_room();

  const Participant& participant_;
  Clients clients_;
  std::uint64_t uses_ = 0;
};

}  // namespace fjr::dds
