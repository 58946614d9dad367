// The subcommands. A new one is one file with an add_... function, declared here and listed in commands.cc; in
// kPlanningCommands, too, if it is to start quickly, for which it may need no library of exports, identification or
// DDS.
#pragma once

#include <array>
#include <filesystem>
#include <span>

namespace CLI {
class App;
}

namespace fjr {

// Adds the subcommand to `app`. When the command line selects it, it runs during parsing and leaves its exit code;
// InputError and unexpected exceptions are left to main().
using AddCommand = void (*)(CLI::App& app, int& exit_code);

void add_plan(CLI::App& app, int& exit_code);
void add_batch(CLI::App& app, int& exit_code);
void add_library(CLI::App& app, int& exit_code);
void add_verify(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_learn(CLI::App& app, int& exit_code);
void add_report(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_keys(CLI::App& app, int& exit_code);
void add_serve(CLI::App& app, int& exit_code);
void add_request(CLI::App& app, int& exit_code);
void add_executor(CLI::App& app, int& exit_code);
void add_hold(CLI::App& app, int& exit_code);
void add_stop(CLI::App& app, int& exit_code);
void add_status(CLI::App& app, int& exit_code);
void add_ros2_action(CLI::App& app, int& exit_code);
void add_worker(CLI::App& app, int& exit_code);
void add_experiment(CLI::App& app, int& exit_code);
void add_identify(CLI::App& app, int& exit_code);
void add_robot(CLI::App& app, int& exit_code);
void add_completion(CLI::App& app, int& exit_code);

// Those that the executable which users call has itself.
inline constexpr std::array<AddCommand, 6> kPlanningCommands{add_plan,   add_batch,  add_library,
                                                             add_verify, add_report, add_keys};

// Returns the subcommands of this executable, in the order of --help: all of them for the complete one (commands.cc),
// kPlanningCommands for the one that users call (planning_commands.cc).
std::span<const AddCommand> commands();

// Returns the executable that has the other commands; empty in that one itself.
std::filesystem::path complete_program();

}  // namespace fjr
