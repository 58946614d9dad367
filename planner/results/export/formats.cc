#include "planner/results/export/formats.h"

#include <array>

#include "common/atomic_file.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

ExportTable columns_of(const Exported& exported) {
  return exported.plan != nullptr ? table_of(exported.plan->robot, *exported.ticked) : table_of(*exported.log);
}

constexpr std::array<ExportFormat, 4> kFormats{{
    {.name = "csv",
     .title = "CSV",
     .suffix = ".csv",
     .meaning = "columns with units, nothing else",
     .write = [](const Exported& exported, const fs::path& file) { write_file(file, as_csv(columns_of(exported))); }},
    {.name = "mat",
     .title = "MATLAB",
     .suffix = ".mat",
     .meaning = "MATLAB",
     .write = [](const Exported& exported, const fs::path& file) { write_mat(exported, columns_of(exported), file); }},
    {.name = "mcap",
     .title = "MCAP",
     .suffix = ".mcap",
     .meaning = "Foxglove, PlotJuggler",
     .log_beside_plan = true,
     .write = [](const Exported& exported, const fs::path& file) { write_file(file, as_mcap(exported)); }},
    {.name = "ros2",
     .title = "ROS 2",
     .suffix = ".ros2.mcap",
     .meaning = "trajectory_msgs/JointTrajectory in MCAP",
     .of_log_alone = false,
     .has_joint_names = true,
     .write = [](const Exported& exported, const fs::path& file) { write_file(file, as_ros2(exported)); }},
}};

}  // namespace

std::span<const ExportFormat> export_formats() { return kFormats; }

}  // namespace fjr
