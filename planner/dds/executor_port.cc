#include "planner/dds/executor_port.h"

#include <algorithm>
#include <utility>

#include "planner/dds/permitted.h"
#include "planner/dds/wire_execution.h"

namespace fjr::dds {

namespace {

Qos of_others() { return std::move(TopicOf<fjr_msg_ExecutorState>::qos().ignore_own()); }

Qos announcing(const std::string& robot_id) {
  return std::move(TopicOf<fjr_msg_ExecutorState>::qos().user_data(robot_id));
}

}  // namespace

ExecutorPort::ExecutorPort(Participant participant, const std::string& robot_id)
    : robot_id_(robot_id),
      participant_(std::move(participant)),
      waitset_(participant_),
      trajectories_2_(participant_, participant_.handle()),
      trajectories_(participant_, participant_.handle()),
      learnt_trajectories_(
          if_permitted<Reader<fjr_msg_LearntTrajectory>>(participant_, TopicOf<fjr_msg_LearntTrajectory>::kName)),
      commands_(participant_, participant_.handle()),
      others_(participant_, of_others()),
      state_(participant_, participant_.handle(), announcing(robot_id)),
      results_(participant_, participant_.handle()),
      runs_(if_permitted<Writer<fjr_msg_ExecutedRun>>(participant_, TopicOf<fjr_msg_ExecutedRun>::kName)),
      drift_(if_permitted<Writer<fjr_msg_ArmDrift>>(participant_, TopicOf<fjr_msg_ArmDrift>::kName)) {
  waitset_.attach(trajectories_2_.arrived());
  waitset_.attach(trajectories_.arrived());
  if (learnt_trajectories_) waitset_.attach(learnt_trajectories_->arrived());
  waitset_.attach(commands_.arrived());
}

std::vector<TrajectoryOrder> ExecutorPort::take_trajectories() {
  std::vector<TrajectoryOrder> orders;
  trajectories_2_.take_all([&](const fjr_msg_Trajectory2& message, const dds_sample_info_t& info) {
    if (info.valid_data) orders.push_back(decode(message));
  });
  trajectories_.take_all([&](const fjr_msg_Trajectory& message, const dds_sample_info_t& info) {
    if (info.valid_data && !also_writes_2(info.publication_handle)) orders.push_back(decode(message));
  });
  if (!learnt_trajectories_) return orders;
  learnt_trajectories_->take_all([&](const fjr_msg_LearntTrajectory& message, const dds_sample_info_t& info) {
    if (info.valid_data) orders.push_back(decode(message));
  });
  return orders;
}

// Returns whether the participant of this writer also has a writer of fjr/trajectory_2. Then its trajectories are read
// from there, where all of them are.
bool ExecutorPort::also_writes_2(dds_instance_handle_t publication) const {
  const auto participant = trajectories_.participant_of(publication);
  if (!participant) return false;
  const std::vector<dds_instance_handle_t> writers = trajectories_2_.writers();
  return std::any_of(writers.begin(), writers.end(), [&](dds_instance_handle_t writer) {
    return trajectories_2_.participant_of(writer) == participant;
  });
}

std::vector<ExecutorOrder> ExecutorPort::take_commands() {
  std::vector<ExecutorOrder> orders;
  commands_.take_all([&](const fjr_msg_ExecutorCommand& message, const dds_sample_info_t& info) {
    if (!info.valid_data) return;
    if (auto order = decode(message)) orders.push_back(std::move(*order));
  });
  return orders;
}

Claimant ExecutorPort::self() const {
  dds_guid_t guid;
  checked(dds_get_guid(participant_.handle(), &guid), "guid");
  return {.guid = std::to_array(guid.v)};
}

std::vector<Claimant> ExecutorPort::announced() const {
  std::vector<Claimant> others;
  for (const Discovery::Key& participant : others_.announced(robot_id_)) others.push_back({.guid = participant});
  return others;
}

std::vector<Claimant> ExecutorPort::take_reporting() {
  std::vector<Claimant> others;
  for (const auto& [source, state] : others_.take()) {
    const auto participant = others_.peer(source);
    if (!participant || state.robot_id != robot_id_) continue;
    // Two executors may prepare the same trajectory. Only the one that reports it as running has moved its arm.
    const bool moved = state.trajectory_id != RequestId{} && state.mode != ExecutorMode::kPreparing;
    others.push_back({.moved = moved, .established = true, .guid = *participant});
  }
  return others;
}

void ExecutorPort::send(const ExecutorState& state) { (void)state_.write(encode(state)); }

void ExecutorPort::send(const ExecutionResult& result) { (void)results_.write(encode(result).message); }

bool ExecutorPort::send(const ExecutedRun& run) { return !runs_ || runs_->write(encode(run)); }

void ExecutorPort::send(const ArmDrift& drift) {
  if (drift_) (void)drift_->write(encode(drift));
}

}  // namespace fjr::dds
