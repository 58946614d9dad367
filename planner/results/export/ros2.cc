#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "common/mcap.h"
#include "planner/results/export/formats.h"

namespace fjr {
namespace {

// The definitions of ROS 2's interfaces, as its recorders put them into their files.
constexpr std::string_view kDefinition = R"(std_msgs/Header header
string[] joint_names
JointTrajectoryPoint[] points
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: trajectory_msgs/JointTrajectoryPoint
float64[] positions
float64[] velocities
float64[] accelerations
float64[] effort
builtin_interfaces/Duration time_from_start
================================================================================
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
)";

// Serialises to XCDR1, little-endian: every value is aligned to its size, relative to the end of the four bytes of the
// encapsulation header.
class Cdr {
 public:
  void add(std::uint32_t value) { add_bytes(&value, sizeof value); }
  void add(std::int32_t value) { add_bytes(&value, sizeof value); }
  void add(double value) { add_bytes(&value, sizeof value); }
  void add(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text;
    bytes_ += '\0';
  }
  void add(const Joints<double>& list) {
    add(static_cast<std::uint32_t>(list.size()));
    for (const double value : list) add(value);
  }
  std::string take() { return std::string("\0\1\0\0", 4) + bytes_; }

 private:
  void add_bytes(const void* value, std::size_t size) {
    bytes_.resize((bytes_.size() + size - 1) / size * size, '\0');
    const std::size_t at = bytes_.size();
    bytes_.resize(at + size);
    std::memcpy(bytes_.data() + at, value, size);  // this machine is little-endian, as all that Debian builds fjr for
  }

  std::string bytes_;
};

void add_time(Cdr& to, double time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t ns = std::llround(time * 1e9);
  to.add(static_cast<std::int32_t>(ns / kSecond));
  to.add(static_cast<std::uint32_t>(ns % kSecond));
}

std::string message(const Parameters& robot, const Ticked& ticked, const Joints<std::string>& names) {
  Cdr cdr;
  add_time(cdr, 0);  // a zero time in the header means that execution begins on reception
  cdr.add(std::string_view(""));
  cdr.add(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) cdr.add(std::string_view(name));
  cdr.add(static_cast<std::uint32_t>(ticked.rows.size()));
  for (std::size_t k = 0; k < ticked.rows.size(); ++k) {
    const State<double>& x = ticked.rows[k].state;
    cdr.add(x.q);
    cdr.add(x.dq);
    cdr.add(link_acceleration(robot, x.q, x.dq, spring_torque(robot, x.q, x.theta)));
    cdr.add(ticked.mean_torque[k]);
    add_time(cdr, ticked.rows[k].time);
  }
  return cdr.take();
}

}  // namespace

std::string as_ros2(const Exported& exported) {
  McapWriter file("ros2", "fjr " FJR_VERSION);
  const std::uint16_t topic =
      file.add_topic("/joint_trajectory", "cdr", "trajectory_msgs/msg/JointTrajectory", "ros2msg", kDefinition);
  file.add(topic, 0, message(exported.plan->robot, *exported.ticked, exported.joint_names));
  return file.finish();
}

}  // namespace fjr
