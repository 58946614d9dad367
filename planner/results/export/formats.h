// The formats of exports: each a function from what there is to the bytes of a file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "planner/results/export/table.h"

namespace fjr {

// What is exported: a plan at its ticks, a log, or both.
struct Exported {
  const PlanRecord* plan = nullptr;
  std::optional<Ticked> ticked;  // of the plan
  std::optional<Log> log;
  Joints<std::string> joint_names{"joint1", "joint2"};
};

// A line of names and lines of numbers, and nothing else; the shortest digits that read back to the same bits.
std::string as_csv(const ExportTable& table);

// JSON messages with JSON schemas: /fjr/trajectory, /fjr/tip, /fjr/limits, /fjr/scene (foxglove.SceneUpdate: the arm
// and what is in its way), and /fjr/executed of a log. Times are those of the motion, from 0.
std::string as_mcap(const Exported& exported);

// One trajectory_msgs/msg/JointTrajectory on /joint_trajectory, CDR, as rosbag2 stores it in MCAP: positions,
// velocities and accelerations of the links, effort: the mean torque of each tick.
std::string as_ros2(const Exported& exported);

// A MATLAB file (level 5): a column vector for each column, a struct `limits`, and texts. Written to `file` at once or
// not at all; throws std::runtime_error where it cannot be.
void write_mat(const Exported& exported, const ExportTable& table, const std::filesystem::path& file);

}  // namespace fjr
