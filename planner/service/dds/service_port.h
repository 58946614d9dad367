// The service's side of the protocol.
#pragma once

#include <chrono>
#include <map>
#include <vector>

#include "planner/service/dds/participant.h"
#include "planner/service/dds/reader.h"
#include "planner/service/dds/waitset.h"
#include "planner/service/dds/writer.h"
#include "planner/service/execution_messages.h"
#include "planner/service/messages.h"

namespace fjr::dds {

class ServicePort {
 public:
  explicit ServicePort(unsigned domain);

  // Until something arrives, wake() is called (from any thread) or the time is over.
  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }
  void wake() const { waitset_.wake(); }

  std::vector<Order> take_requests();
  std::vector<RequestId> take_cancels();

  // To the client's own partition. False: the client is too slow, and will ask again.
  bool send(const Reply& reply);
  void send(const ProgressReport& report);
  void send(const ServiceStatus& status);
  bool send(const TrajectoryOrder& order);  // to the executor

  // Waits until the clients have their replies, at most so long.
  void flush(std::chrono::nanoseconds timeout);

 private:
  using ClientKey = std::array<std::uint8_t, 16>;
  struct Client {
    Client(const Participant& participant, const RequestId& id);
    Entity publisher;
    Writer<fjr_msg_PlanReply> replies;
    Writer<fjr_msg_PlanStatus> progress;
    std::uint64_t last_used = 0;
  };

  Client& client(const RequestId& id);

  Participant participant_;
  Waitset waitset_;
  Reader<fjr_msg_PlanRequest> requests_;
  Reader<fjr_msg_PlanCancel> cancels_;
  Writer<fjr_msg_PlannerStatus> status_;
  Writer<fjr_msg_Trajectory> trajectories_;
  std::map<ClientKey, Client> clients_;
  std::uint64_t uses_ = 0;
};

}  // namespace fjr::dds
