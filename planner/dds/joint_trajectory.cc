#include "planner/dds/joint_trajectory.h"

#include <array>
#include <cmath>
#include <utility>

#include "model/dynamics.h"

namespace fjr::dds {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;

// The values that the four lists of one point refer to.
struct Point {
  Joints<double> q, dq, ddq, torque;
};

Point point_of(const Parameters& robot, const Sample& row) {
  const State<double>& x = row.state;
  return {x.q, x.dq, link_acceleration(robot, x.q, x.dq, spring_torque(robot, x.q, x.theta)), row.torque};
}

// Only read when written.
dds_sequence_double list_of(Joints<double>& values) { return {kJoints, kJoints, values.data(), false}; }

builtin_interfaces_msg_dds__Duration_ duration_of(double time) {
  const auto nanoseconds = static_cast<std::int64_t>(std::llround(time * 1e9));
  return {static_cast<std::int32_t>(nanoseconds / kNanoseconds),
          static_cast<std::uint32_t>(nanoseconds % kNanoseconds)};
}

}  // namespace

JointTrajectoryWriter::JointTrajectoryWriter(const Participant& participant, const Parameters& robot,
                                             std::vector<std::string> joint_names)
    : robot_(robot), names_(std::move(joint_names)), writer_(participant, participant.handle()) {}

void JointTrajectoryWriter::send(const TrajectoryOrder& order) {
  std::vector<Point> values;
  values.reserve(order.rows.size());
  std::vector<trajectory_msgs_msg_dds__JointTrajectoryPoint_> points;
  for (const Sample& row : order.rows) {
    Point& value = values.emplace_back(point_of(robot_, row));
    points.push_back({list_of(value.q), list_of(value.dq), list_of(value.ddq), list_of(value.torque),
                      duration_of(row.time - order.rows.front().time)});
  }
  std::array<char*, kJoints> names{names_[0].data(), names_[1].data()};
  std::string frame;
  JointTrajectory message{};
  message.header_.stamp_ = {static_cast<std::int32_t>(order.published / kNanoseconds),
                            static_cast<std::uint32_t>(order.published % kNanoseconds)};
  message.header_.frame_id_ = frame.data();
  message.joint_names_._length = message.joint_names_._maximum = kJoints;
  message.joint_names_._buffer = names.data();
  message.points_._length = message.points_._maximum = static_cast<std::uint32_t>(points.size());
  message.points_._buffer = points.data();
  (void)writer_.write(message);  // a slow reader may miss one
}

}  // namespace fjr::dds
