#include "planner/program/commands.h"

#include <array>

namespace fjr {
namespace {

constexpr std::array<AddCommand, 21> kAll{
    add_plan,   add_batch,       add_library, add_verify,     add_simulate, add_learn, add_report,
    add_export, add_keys,        add_serve,   add_request,    add_executor, add_hold,  add_stop,
    add_status, add_ros2_action, add_worker,  add_experiment, add_identify, add_robot, add_completion};

}  // namespace

std::span<const AddCommand> commands() { return kAll; }

std::filesystem::path complete_program() { return {}; }

}  // namespace fjr
