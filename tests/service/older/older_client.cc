// A client that was compiled with the types of version 0.1:  older_client DOMAIN
// Has motions planned, cancelled and executed, and the arm held; prints what came of it.
#include <dds/dds.h>
#include <types_of_0_1.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include "planner/dds/entity.h"
#include "planner/dds/qos.h"

namespace {

using fjr::dds::Entity;
using fjr::dds::Qos;

constexpr const char* kPartition = "6f6c6465720000000000000000000000";  // the client's 16 bytes in hexadecimal

fjr_msg_RequestId id(std::uint64_t number) { return {{'o', 'l', 'd', 'e', 'r'}, number}; }
bool same(const fjr_msg_RequestId& a, const fjr_msg_RequestId& b) {
  return std::equal(std::begin(a.client), std::end(a.client), b.client) && a.number == b.number;
}

fjr_msg_PlanRequest request(std::uint64_t number, double q1, double q2) {
  fjr_msg_PlanRequest message{};
  message.id = id(number);
  message.goal.q[0] = q1;
  message.goal.q[1] = q2;
  return message;
}

// The samples of one topic live as long as the next is taken.
template <class T>
class Reader {
 public:
  Reader(dds_entity_t participant, dds_entity_t parent, const char* name, const dds_topic_descriptor_t& type,
         const Qos& qos)
      : topic_(dds_create_topic(participant, &type, name, nullptr, nullptr), name),
        reader_(dds_create_reader(parent, topic_.handle(), qos.get(), nullptr), name) {}

  // What `holds` of a sample that arrives within half a minute; its sequences are left out.
  template <class Holds>
  std::optional<T> next(Holds holds) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < end) {
      void* loan = nullptr;
      dds_sample_info_t info{};
      if (dds_take(reader_.handle(), &loan, &info, 1, 1) <= 0) {
        dds_sleepfor(DDS_MSECS(2));
        continue;
      }
      const T sample = *static_cast<const T*>(loan);
      const bool found = info.valid_data && holds(sample);
      dds_return_loan(reader_.handle(), &loan, 1);
      if (found) return sample;
    }
    return std::nullopt;
  }

 private:
  Entity topic_, reader_;
};

class Writer {
 public:
  Writer(dds_entity_t participant, const char* name, const dds_topic_descriptor_t& type)
      : topic_(dds_create_topic(participant, &type, name, nullptr, nullptr), name),
        writer_(dds_create_writer(participant, topic_.handle(), Qos().reliable(DDS_SECS(1)).keep_all().get(), nullptr),
                name) {
    dds_publication_matched_status_t matched{};
    for (int i = 0; i < 500 && matched.current_count == 0; ++i) {
      dds_sleepfor(DDS_MSECS(20));
      dds_get_publication_matched_status(writer_.handle(), &matched);
    }
    if (matched.current_count == 0) std::printf("nobody reads %s\n", name);
  }
  void write(const void* sample) const { fjr::dds::checked(dds_write(writer_.handle(), sample), "write"); }

 private:
  Entity topic_, writer_;
};

}  // namespace

int main(int, char** argv) {
  const Entity participant(dds_create_participant(static_cast<dds_domainid_t>(std::atoi(argv[1])), nullptr, nullptr),
                           "participant");
  const dds_entity_t all = participant.handle();
  const Entity mine(dds_create_subscriber(all, Qos().partition(kPartition).get(), nullptr), "subscriber");
  const Qos reliable = std::move(Qos().reliable(DDS_SECS(1)).transient_local().keep_all());
  const Qos latest = std::move(Qos().best_effort().keep_last(1));
  const Reader<fjr_msg_PlanReply> replies(all, mine.handle(), "fjr/plan_reply", fjr_msg_PlanReply_desc, reliable);
  const Reader<fjr_msg_PlanStatus> progress(all, mine.handle(), "fjr/plan_status", fjr_msg_PlanStatus_desc, latest);
  const Reader<fjr_msg_PlannerStatus> services(all, all, "fjr/planner_status", fjr_msg_PlannerStatus_desc, reliable);
  const Reader<fjr_msg_Trajectory> trajectories(
      all, all, "fjr/trajectory", fjr_msg_Trajectory_desc,
      std::move(Qos().reliable(DDS_SECS(1)).keep_last(1).exclusive_ownership()));
  const Reader<fjr_msg_ExecutorState> states(all, all, "fjr/executor_state", fjr_msg_ExecutorState_desc, latest);
  const Reader<fjr_msg_ExecutionResult> results(all, all, "fjr/execution_result", fjr_msg_ExecutionResult_desc,
                                                reliable);
  const Writer requests(all, "fjr/plan_request", fjr_msg_PlanRequest_desc);
  const Writer requests_2(all, "fjr/plan_request_2", fjr_msg_PlanRequest2_desc);
  const Writer cancels(all, "fjr/plan_cancel", fjr_msg_PlanCancel_desc);
  const Writer commands(all, "fjr/executor_command", fjr_msg_ExecutorCommand_desc);

  const auto final_state = [&](std::uint64_t number) {
    const auto reply = replies.next([&](const fjr_msg_PlanReply& sample) {
      return same(sample.id, id(number)) && sample.state != fjr_msg_STATE_ACCEPTED;
    });
    if (reply && *reply->sentence != 0) std::printf("%s\n", reply->sentence);
    return reply ? reply->state : 0;
  };

  fjr_msg_PlanRequest planned = request(1, 0.42, 0.08);
  planned.start = {.given = true, .q = {0.3, 0.2}};
  requests.write(&planned);
  std::printf("planned: %d\n", final_state(1));

  fjr_msg_Posture corner{{0.36, 0.12}};
  fjr_msg_PlanRequest2 along_a_path{.request = planned};
  along_a_path.request.id = id(2);
  along_a_path.path = {.given = true, .points = {1, 1, &corner, false}, .tolerance = 0.01};
  requests_2.write(&along_a_path);
  std::printf("along a path: %d\n", final_state(2));

  fjr_msg_PlanRequest slow = request(3, 1.2, -0.8);
  slow.start.given = true;
  slow.objective.preset = fjr_msg_OBJECTIVE_EFFICIENT;
  slow.duration = {.has_min = true, .min = 1.5, .has_max = true, .max = 1.5};
  requests.write(&slow);
  std::printf("progress: %d\n", progress.next([&](const auto& sample) { return same(sample.id, id(3)); }).has_value());
  const fjr_msg_PlanCancel cancel{id(3)};
  cancels.write(&cancel);
  std::printf("cancelled: %d\n", final_state(3));

  fjr_msg_PlanRequest executed = request(4, 0.3, -0.2);  // from where the arm rests
  executed.action = fjr_msg_ACTION_PLAN_AND_EXECUTE;
  requests.write(&executed);
  const auto trajectory = trajectories.next([&](const auto& sample) { return same(sample.id, id(4)); });
  std::printf("certified: %d\n", trajectory && trajectory->certified);
  const auto result = results.next([&](const auto& sample) { return same(sample.trajectory_id, id(4)); });
  std::printf("executed: %d\n", result ? result->error_code : 1);
  const auto arrived = states.next([](const auto&) { return true; });
  std::printf("is there: %d\n",
              arrived && std::abs(arrived->q[0] - 0.3) < 0.01 && std::abs(arrived->q[1] + 0.2) < 0.01);

  const auto owner = services.next([](const auto& sample) { return sample.solved >= 3; });
  std::printf("counted: %d\n", owner.has_value());
  const fjr_msg_ExecutorCommand hold{.robot_id = "", .id = id(5), .command = fjr_msg_COMMAND_HOLD};
  fjr_msg_ExecutorCommand to_the_arm = hold;
  if (arrived) std::copy(std::begin(arrived->robot_id), std::end(arrived->robot_id), to_the_arm.robot_id);
  commands.write(&to_the_arm);
  const auto held = states.next([](const auto& sample) { return sample.mode == fjr_msg_MODE_HOLDING; });
  std::printf("held: %d\n", held.has_value());
}
