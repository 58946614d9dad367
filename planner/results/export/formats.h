// The formats of exports. A new one is a line in formats.cc and the function that it names; the options of `fjr
// export`, their help and what they refuse go by that list.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "planner/results/export/table.h"

namespace fjr {

// The data to export: a plan at its ticks, a log, or both.
struct Exported {
  const PlanRecord* plan = nullptr;
  std::optional<Ticked> ticked;  // of the plan
  std::optional<Log> log;
  Joints<std::string> joint_names{"joint1", "joint2"};
};

struct ExportFormat {
  std::string_view name;         // "ros2", of --format
  std::string_view title;        // "ROS 2"
  std::string_view suffix;       // ".ros2.mcap", of the file
  std::string_view meaning;      // what is in the file, or who reads it
  bool of_log_alone = true;      // a log is exported without a plan, too
  bool log_beside_plan = false;  // a log is written into the same file as its plan
  bool has_joint_names = false;  // uses Exported::joint_names
  void (*write)(const Exported&, const std::filesystem::path& file);
};

// All of them, in the order of --help.
std::span<const ExportFormat> export_formats();

// Returns CSV with one line of names and lines of numbers, with the fewest digits that read back to the same bits.
std::string as_csv(const ExportTable& table);

// JSON messages with JSON schemas: /fjr/trajectory, /fjr/tip, /fjr/limits, /fjr/scene (foxglove.SceneUpdate: the arm
// and what is in its way), and /fjr/executed of a log. Times are those of the motion, from 0.
std::string as_mcap(const Exported& exported);

// One trajectory_msgs/msg/JointTrajectory on /joint_trajectory, CDR, as rosbag2 stores it in MCAP: positions,
// velocities and accelerations of the links, effort: the mean torque of each tick.
std::string as_ros2(const Exported& exported);

// Writes a MATLAB file (level 5) with a column vector for each column, a struct `limits`, and texts. The file is
// replaced atomically. Throws std::runtime_error if it cannot be written.
void write_mat(const Exported& exported, const ExportTable& table, const std::filesystem::path& file);

}  // namespace fjr
