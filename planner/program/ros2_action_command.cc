// fjr ros2-action: ROS 2's action FollowJointTrajectory, served by the planning service and the executor.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <thread>

#include "common/input_error.h"
#include "planner/program/commands.h"
#include "planner/program/ending.h"
#include "planner/program/network_arguments.h"
#include "planner/program/service_log.h"
#include "planner/ros2/action_server.h"
#include "planner/service/service_config.h"

namespace fjr {
namespace {

struct Ros2ActionArguments {
  std::string config;
  std::string robot_id;
  std::string action;
  bool leave_accelerations = false;
  bool with_indices = false;
  NetworkArguments network;
};

// The action server is configured by the configuration of the service.
ActionServerConfig configured(const Ros2ActionArguments& options) {
  const ServiceConfig service = options.config.empty() ? default_service_config() : load_service_config(options.config);
  const std::vector<ServiceConfig> arms = one_per_robot(service);
  if (options.robot_id.empty() && arms.size() > 1) {
    throw InputError(options.config, "robots", "of these one is meant: give its id as --robot-id");
  }
  ActionServerConfig config;
  config.network = service.network;
  options.network.apply_to(config.network);
  config.robot_id = options.robot_id.empty() ? arms.front().robot_id : options.robot_id;
  config.action = options.action;
  config.reading = {{service.joint_names[0], service.joint_names[1]}, options.leave_accelerations};
  config.with_indices = options.with_indices;
  return config;
}

int serve_action(const Ros2ActionArguments& options) {
  catch_ending_signals();  // before any other thread is started
  ::signal(SIGPIPE, SIG_IGN);
  const auto log = log_to_stderr();
  ActionServer server(configured(options));
  const std::jthread ending = stop_at_end(server);
  server.run();
  return 0;
}

}  // namespace

void add_ros2_action(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<Ros2ActionArguments>();
  CLI::App* command = app.add_subcommand(
      "ros2-action", "Serve ROS 2's action FollowJointTrajectory by the service and the executor, until SIGTERM");
  command
      ->add_option("--config", options->config,
                   "The service's configuration: domain, robot_id, ros2.joint_names, security; without it the defaults")
      ->type_name("SERVICE.yaml");
  command->add_option("--action", options->action, "Full name; without it /ROBOT_ID/follow_joint_trajectory")
      ->type_name("NAME");
  command->add_option("--robot-id", options->robot_id, "Name of the arm on DDS, if not the configuration's")
      ->type_name("NAME");
  command->add_flag("--leave-accelerations", options->leave_accelerations,
                    "Take goals with accelerations at intermediate points, which the planner then chooses itself");
  command->add_flag("--kilted", options->with_indices,
                    "Feedback as of control_msgs 6.3, for ROS 2 Kilted and later: with the members index");
  add_network_options(*command, options->network);
  command->callback([options, &exit_code] { exit_code = serve_action(*options); });
}

}  // namespace fjr
