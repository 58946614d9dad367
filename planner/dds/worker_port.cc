#include "planner/dds/worker_port.h"

#include <utility>

#include "planner/dds/text.h"
#include "planner/dds/wire_work.h"

namespace fjr::dds {

// The writer of offers is created last, so that an owner that receives an offer can already grant leases.
WorkerPort::WorkerPort(Participant participant, const WorkerId& worker)
    : participant_(std::move(participant)),
      waitset_(participant_),
      partition_(participant_.subscriber(client_name({worker, 0}))),
      leases_(participant_, partition_.handle()),
      services_(participant_, participant_.handle()),
      results_(participant_, participant_.handle()),
      offers_(participant_, participant_.handle()) {
  waitset_.attach(leases_.arrived());
}

std::vector<LeaseWord> WorkerPort::take_leases() {
  std::vector<LeaseWord> words;
  leases_.take_all([&](const fjr_msg_WorkLease& message, const dds_sample_info_t& info) {
    if (info.valid_data) words.push_back(decode(message));
  });
  return words;
}

std::vector<WorkerPort::Heard> WorkerPort::take_heard() {
  std::vector<Heard> heard;
  services_.take_all([&](const fjr_msg_PlannerStatus& message, const dds_sample_info_t& info) {
    if (info.valid_data) heard.push_back({text_of(message.instance), info.publication_handle});
  });
  return heard;
}

void WorkerPort::send(const WorkerOffer& offer) { (void)offers_.write(encode(offer).message); }

bool WorkerPort::send(const WorkResult& result) { return results_.write(encode(result)); }

}  // namespace fjr::dds
