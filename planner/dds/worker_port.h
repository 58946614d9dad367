// The worker's side of the protocol: receives leases, sends offers and results.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/dds/waitset.h"
#include "planner/dds/writer.h"
#include "planner/protocol/work_messages.h"

namespace fjr::dds {

class WorkerPort {
 public:
  WorkerPort(Participant participant, const WorkerId& worker);

  // Waits until something arrives, wake() is called (from any thread) or the timeout is over.
  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }
  void wake() const { waitset_.wake(); }

  std::vector<LeaseWord> take_leases();  // in the order of one owner's words
  struct Heard {                         // a service that has said that it is there
    std::string instance;
    std::uint64_t process = 0;  // changes when it is restarted
  };
  std::vector<Heard> take_heard();

  void send(const WorkerOffer& offer);
  bool send(const WorkResult& result);  // false: the owner is too slow
  void flush(std::chrono::nanoseconds timeout) const { (void)results_.flush(timeout.count()); }

 private:
  Participant participant_;
  Waitset waitset_;
  Entity partition_;
  Reader<fjr_msg_WorkLease> leases_;
  Reader<fjr_msg_PlannerStatus> services_;
  Writer<fjr_msg_WorkResult> results_;
  Writer<fjr_msg_WorkerOffer> offers_;
};

}  // namespace fjr::dds
