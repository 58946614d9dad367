// The topics: names, types and quality of service in one table. Readers and writers of a topic share its Qos.
#pragma once

#include <dds/dds.h>
#include <fjr_msgs.h>
#include <fjr_plan_request.h>
#include <fjr_work.h>

#include "planner/dds/qos.h"

namespace fjr::dds {

template <class T>
struct TopicOf;  // name, descriptor(), qos()

template <>
struct TopicOf<fjr_msg_PlanRequest> {
  static constexpr const char* kName = "fjr/plan_request";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_PlanRequest_desc; }
  // The service takes everything at once into its own bounded queue: limits here would block healthy clients.
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(100)).keep_all()); }
};

template <>
struct TopicOf<fjr_msg_PlanRequest2> {
  static constexpr const char* kName = "fjr/plan_request_2";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_PlanRequest2_desc; }
  static Qos qos() { return TopicOf<fjr_msg_PlanRequest>::qos(); }
};

template <>
struct TopicOf<fjr_msg_PlanCancel> {
  static constexpr const char* kName = "fjr/plan_cancel";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_PlanCancel_desc; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(100)).keep_last(16)); }
};

template <>
struct TopicOf<fjr_msg_MotionRequest> {
  static constexpr const char* kName = "fjr/motion_request";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_MotionRequest_desc; }
  static Qos qos() { return TopicOf<fjr_msg_PlanRequest>::qos(); }
};

template <>
struct TopicOf<fjr_msg_MotionCancel> {
  static constexpr const char* kName = "fjr/motion_cancel";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_MotionCancel_desc; }
  static Qos qos() { return TopicOf<fjr_msg_PlanCancel>::qos(); }
};

template <>
struct TopicOf<fjr_msg_RelayedRequest> {
  static constexpr const char* kName = "fjr/relayed_request";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_RelayedRequest_desc; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(0)).keep_last(256)); }
};

// There is one writer per client in the client's own partition, because with a shared writer a stalled client would
// delay the replies to others. Replies are not overwritten before the client has them, and the writer does not block:
// replies that find no room are kept by the service and tried again (outbox.h).
template <>
struct TopicOf<fjr_msg_PlanReply> {
  static constexpr const char* kName = "fjr/plan_reply";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_PlanReply_desc; }
  static Qos qos() {
    return std::move(
        Qos().reliable(DDS_MSECS(0)).transient_local().late_joiners_get(4).keep_all().lifespan(DDS_SECS(60)));
  }
};

template <>
struct TopicOf<fjr_msg_PlanStatus> {
  static constexpr const char* kName = "fjr/plan_status";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_PlanStatus_desc; }
  static Qos qos() { return std::move(Qos().best_effort().keep_last(1)); }
};

// Liveliness is asserted by the working thread, so that a service that hangs is noticed like one that has ended.
template <>
struct TopicOf<fjr_msg_PlannerStatus> {
  static constexpr const char* kName = "fjr/planner_status";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_PlannerStatus_desc; }
  static Qos qos() {
    return std::move(Qos().reliable(DDS_MSECS(5)).transient_local().keep_last(1).manual_liveliness(DDS_MSECS(500)));
  }
};

// A restarted executor gets the latest trajectory, and of two owners the one with the higher ownership strength counts.
// The history is deep enough that trajectories published in quick succession do not overwrite each other, because each
// must get a result. 64 of them take up to 190 MB, and about 6 s to be planned.
template <>
struct TopicOf<fjr_msg_Trajectory> {
  static constexpr const char* kName = "fjr/trajectory";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_Trajectory_desc; }
  static Qos qos() {
    return std::move(Qos()
                         .reliable(DDS_MSECS(100))
                         .transient_local()
                         .late_joiners_get(1)
                         .keep_last(64)
                         .exclusive_ownership()
                         .automatic_liveliness(DDS_MSECS(500))
                         .keep_instances());
  }
};

template <>
struct TopicOf<fjr_msg_Trajectory2> {
  static constexpr const char* kName = "fjr/trajectory_2";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_Trajectory2_desc; }
  static Qos qos() { return TopicOf<fjr_msg_Trajectory>::qos(); }
};

template <>
struct TopicOf<fjr_msg_LearntTrajectory> {
  static constexpr const char* kName = "fjr/learnt_trajectory";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_LearntTrajectory_desc; }
  static Qos qos() { return TopicOf<fjr_msg_Trajectory>::qos(); }
};

template <>
struct TopicOf<fjr_msg_ExecutorCommand> {
  static constexpr const char* kName = "fjr/executor_command";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_ExecutorCommand_desc; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(100)).keep_last(16)); }
};

// Telemetry, of which the latest counts. Two executors of one robot write the same instance alternately; the history is
// deep enough to contain states of both.
template <>
struct TopicOf<fjr_msg_ExecutorState> {
  static constexpr const char* kName = "fjr/executor_state";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_ExecutorState_desc; }
  static Qos qos() {
    return std::move(Qos().best_effort().keep_last(8).deadline(DDS_MSECS(3)).automatic_liveliness(DDS_MSECS(300)));
  }
};

template <>
struct TopicOf<fjr_msg_ExecutionResult> {
  static constexpr const char* kName = "fjr/execution_result";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_ExecutionResult_desc; }
  static Qos qos() {
    return std::move(Qos().reliable(DDS_MSECS(5)).transient_local().keep_last(64).automatic_liveliness(DDS_MSECS(300)));
  }
};

// Runs are kept for services that join or restart, which continue to learn from them. For motions that are executed in
// turn, the last run of each is needed. A motion of 1 s takes 130 kB.
template <>
struct TopicOf<fjr_msg_ExecutedRun> {
  static constexpr const char* kName = "fjr/executed_run";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_ExecutedRun_desc; }
  static Qos qos() {
    return std::move(Qos().reliable(DDS_MSECS(20)).transient_local().late_joiners_get(16).keep_last(16));
  }
};

// Only the latest report counts, also for late joiners.
template <>
struct TopicOf<fjr_msg_ArmDrift> {
  static constexpr const char* kName = "fjr/arm_drift";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_ArmDrift_desc; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(5)).transient_local().keep_last(1)); }
};

// A worker's heartbeat. Late joiners get the last one at once.
template <>
struct TopicOf<fjr_msg_WorkerOffer> {
  static constexpr const char* kName = "fjr/worker_offer";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_WorkerOffer_desc; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(5)).transient_local().keep_last(1)); }
};

// There is one writer per worker in the worker's own partition, so that a stuck worker does not delay others. A job
// whose lease expires is granted to another worker.
template <>
struct TopicOf<fjr_msg_WorkLease> {
  static constexpr const char* kName = "fjr/work_lease";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_WorkLease_desc; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(0)).keep_all()); }
};

// A worker repeats a result until it is taken, so that its writer need not block for a stuck owner.
template <>
struct TopicOf<fjr_msg_WorkResult> {
  static constexpr const char* kName = "fjr/work_result";
  static const dds_topic_descriptor_t* descriptor() { return &fjr_msg_WorkResult_desc; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(0)).keep_all()); }
};

}  // namespace fjr::dds
