// Trajectories as ROS 2's trajectory_msgs/JointTrajectory on /joint_trajectory, for its tools to see the motion.
#pragma once

#include <trajectory_msgs.h>

#include <string>
#include <vector>

#include "model/parameters.h"
#include "planner/dds/participant.h"
#include "planner/dds/writer.h"
#include "planner/protocol/execution_messages.h"

namespace fjr::dds {

using JointTrajectory = trajectory_msgs_msg_dds__JointTrajectory_;

template <>
struct TopicOf<JointTrajectory> {
  static constexpr const char* kName = "rt/joint_trajectory";  // as ROS 2 names topics on the wire
  static const dds_topic_descriptor_t* descriptor() { return &trajectory_msgs_msg_dds__JointTrajectory__desc; }
  static Qos qos() { return std::move(Qos().reliable(DDS_MSECS(0)).keep_last(1)); }
};

class JointTrajectoryWriter {
 public:
  JointTrajectoryWriter(const Participant& participant, const Parameters& robot, std::vector<std::string> joint_names);

  // Link positions [rad], velocities and accelerations, with the motors' torques [N m] as efforts.
  void send(const TrajectoryOrder& order);

 private:
  const Parameters robot_;
  std::vector<std::string> names_;
  Writer<JointTrajectory> writer_;
};

}  // namespace fjr::dds
