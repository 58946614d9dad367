// service.yaml: how `fjr serve` runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/protocol/network.h"
#include "planner/service/solve_loop.h"

namespace fjr {

struct ServedRobot {
  std::string id;
  std::filesystem::path file;
};

struct ServiceConfig {
  Network network;
  std::string instance;             // unique among the running services; by default host name and process
  std::string robot_id = "arm";     // robot whose trajectories it publishes
  std::filesystem::path robot;      // its robot.yaml
  std::vector<ServedRobot> robots;  // instead of these two: several robots in one process
  std::size_t workers = 1;          // solving processes; 0: only workers on other machines solve
  std::size_t jobs = 1;             // threads per solving process
  std::size_t queue = 64;           // waiting requests allowed per participant
  std::size_t warm_plans = 32;      // minimum-time plans that each worker keeps to start neighbouring ones from
  std::filesystem::path library;    // folder of a plan library to start from and to learn into; empty: none
  std::filesystem::path remember;   // folder of the replies that are remembered over a restart; empty: none are
  double budget = 60;               // [s] for a request that names none
  double longest_budget = 600;      // [s] a request may ask for
  std::optional<std::uint16_t> metrics_port;  // on the loopback interface, for Prometheus; 0: any
  bool joint_trajectory = false;              // for ROS 2: what goes to the executor also goes to rt/joint_trajectory
  std::vector<std::string> joint_names{"joint1", "joint2"};
  double rehearsal = 0;  // [s] that each solving process waits in place of planning; 0: it plans
};

// Returns the defaults, with the robot file shipped with the program and the credentials that FJR_SECURITY names.
ServiceConfig default_service_config();

// Returns one configuration per robot. If there are several, each gets an instance name of its own.
std::vector<ServiceConfig> one_per_robot(const ServiceConfig& config);

WorkerSettings worker_settings(const ServiceConfig& config);

// Throws InputError naming file, field, value and what is allowed.
ServiceConfig load_service_config(const std::filesystem::path& file);

}  // namespace fjr
