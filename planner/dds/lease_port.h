// The owner's side of the protocol with workers: receives offers and results, sends leases.
#pragma once

#include <map>
#include <vector>

#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/dds/waitset.h"
#include "planner/dds/writer.h"
#include "planner/protocol/work_messages.h"

namespace fjr::dds {

class LeasePort {
 public:
  // Incoming messages wake up `waitset`, which must outlive this object.
  LeasePort(const Participant& participant, Waitset& waitset);
  ~LeasePort();
  LeasePort(const LeasePort&) = delete;
  LeasePort& operator=(const LeasePort&) = delete;

  struct Offer {
    WorkerOffer offer;  // only the worker's id is set if it is gone
    bool alive = false;
  };
  std::vector<Offer> take_offers();  // the latest word of each
  std::vector<WorkResult> take_results();

  // Creates a writer for a worker. Leases can be sent once the worker has discovered it, which takes milliseconds.
  void meet(const WorkerId& worker);
  void forget(const WorkerId& worker);
  bool reachable(const WorkerId& worker) const;
  bool send(const WorkerId& worker, const LeaseWord& word);  // false: it is not reachable, or too slow

  // Waits until the workers have received everything, at most for the timeout.
  void flush(std::chrono::nanoseconds timeout) const;

 private:
  struct Worker {
    Worker(const Participant& participant, const WorkerId& worker);

    Entity publisher;
    Writer<fjr_msg_WorkLease> leases;
  };

  const Participant& participant_;
  Reader<fjr_msg_WorkerOffer> offers_;
  Reader<fjr_msg_WorkResult> results_;
  std::map<WorkerId, Worker> workers_;
  std::vector<std::map<WorkerId, Worker>::node_type> forgotten_;
};

}  // namespace fjr::dds
