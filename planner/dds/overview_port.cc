#include "planner/dds/overview_port.h"

#include <utility>

#include "planner/dds/permitted.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/wire_reply.h"

namespace fjr::dds {

// States of executors, which come a thousand times a second, do not end the wait. They are read when something else
// does.
OverviewPort::OverviewPort(Participant participant)
    : participant_(std::move(participant)),
      waitset_(participant_),
      discovery_(participant_),
      services_(participant_, participant_.handle()),
      executors_(participant_),
      drifts_(if_permitted<Reader<fjr_msg_ArmDrift>>(participant_, TopicOf<fjr_msg_ArmDrift>::kName)) {
  waitset_.attach(services_.arrived());
}

std::vector<ServiceStatus> OverviewPort::take_services() {
  std::vector<ServiceStatus> services;
  services_.take_all([&](const fjr_msg_PlannerStatus& message, const dds_sample_info_t& info) {
    if (info.valid_data) services.push_back(decode(message));
  });
  return services;
}

std::vector<ArmDrift> OverviewPort::take_drifts() {
  std::vector<ArmDrift> drifts;
  if (!drifts_) return drifts;
  drifts_->take_all([&](const fjr_msg_ArmDrift& message, const dds_sample_info_t& info) {
    if (info.valid_data) drifts.push_back(decode(message));
  });
  return drifts;
}

}  // namespace fjr::dds
