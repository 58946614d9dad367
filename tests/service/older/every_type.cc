// Every topic of version 0.1, with the types of one IDL file:  every_type DOMAIN
// Writes a sample on each and waits for one of another process: says that it has everything, or names the topics from
// which none has come.
#include <dds/dds.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include FJR_TYPES  // the C header of that IDL file
#include "planner/dds/entity.h"
#include "planner/dds/qos.h"

namespace {

using fjr::dds::Entity;
using fjr::dds::Qos;

class Topic {
 public:
  Topic(dds_entity_t participant, const char* name, const dds_topic_descriptor_t& type)
      : name_(name),
        topic_(dds_create_topic(participant, &type, name, qos().get(), nullptr), name),
        reader_(dds_create_reader(participant, topic_.handle(), qos().get(), nullptr), name),
        writer_(dds_create_writer(participant, topic_.handle(), qos().get(), nullptr), name) {
    const std::vector<double> zeros(type.m_size / sizeof(double) + 1);
    fjr::dds::checked(dds_write(writer_.handle(), zeros.data()), name);
  }

  const char* name() const { return name_; }

  bool received() {
    void* loan = nullptr;
    dds_sample_info_t info{};
    const int count = dds_take(reader_.handle(), &loan, &info, 1, 1);
    received_ |= count > 0 && info.valid_data;
    if (count > 0) dds_return_loan(reader_.handle(), &loan, count);
    return received_;
  }

 private:
  static Qos qos() { return std::move(Qos().reliable(DDS_SECS(1)).transient_local().ignore_own()); }

  const char* name_;
  Entity topic_, reader_, writer_;
  bool received_ = false;
};

}  // namespace

int main(int, char** argv) {
  const Entity participant(dds_create_participant(static_cast<dds_domainid_t>(std::atoi(argv[1])), nullptr, nullptr),
                           "participant");
  std::vector<Topic> topics;
  const auto add = [&](const char* name, const dds_topic_descriptor_t& type) {
    topics.emplace_back(participant.handle(), name, type);
  };
  add("fjr/plan_request", fjr_msg_PlanRequest_desc);
  add("fjr/plan_request_2", fjr_msg_PlanRequest2_desc);
  add("fjr/plan_cancel", fjr_msg_PlanCancel_desc);
  add("fjr/plan_reply", fjr_msg_PlanReply_desc);
  add("fjr/plan_status", fjr_msg_PlanStatus_desc);
  add("fjr/planner_status", fjr_msg_PlannerStatus_desc);
  add("fjr/trajectory", fjr_msg_Trajectory_desc);
  add("fjr/executor_command", fjr_msg_ExecutorCommand_desc);
  add("fjr/executor_state", fjr_msg_ExecutorState_desc);
  add("fjr/execution_result", fjr_msg_ExecutionResult_desc);

  const auto missing = [&] {
    return std::count_if(topics.begin(), topics.end(), [](Topic& topic) { return !topic.received(); });
  };
  for (int i = 0; i < 500 && missing() > 0; ++i) dds_sleepfor(DDS_MSECS(20));
  for (Topic& topic : topics) {
    if (!topic.received()) std::printf("nothing on %s\n", topic.name());
  }
  if (missing() > 0) return 1;
  std::puts("everything");
  std::fflush(stdout);
  // Until it is ended, for a minute at most: the other process may not have all of them yet, and to wait for
  // acknowledgements would not wait for a reader that is told what was written before it came.
  dds_sleepfor(DDS_SECS(60));
}
