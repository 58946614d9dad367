// fjr serve: the planning service on DDS; fjr worker: one of its solving processes.
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "common/input_error.h"
#include "planner/program/commands.h"
#include "planner/program/ending.h"
#include "planner/program/network_arguments.h"
#include "planner/program/number_checks.h"
#include "planner/program/service_log.h"
#include "planner/service/one_per_robot.h"
#include "planner/service/service.h"
#include "planner/service/solve_loop.h"
#include "planner/service/worker_host.h"

namespace fjr {
namespace {

struct ServeArguments {
  std::string config;
  NetworkArguments network;
  std::optional<std::size_t> workers;  // by default as configured
  bool worker_only = false;
  double rehearsal = 0;  // [s]
};

template <class Host>
int run(const ServiceConfig& config) {
  OnePerRobot<Host> hosts(config);
  const std::jthread ending = stop_at_end(hosts);
  hosts.run();
  return 0;
}

int serve(const ServeArguments& options) {
  catch_ending_signals();  // before any other thread is started
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);  // writing to a file that may not grow then returns an error
  const auto log = log_to_stderr();
  ServiceConfig config = options.config.empty() ? default_service_config() : load_service_config(options.config);
  options.network.apply_to(config.network);
  config.workers = options.workers.value_or(config.workers);
  config.rehearsal = options.rehearsal;
  if (!options.worker_only) return run<Service>(config);
  if (config.workers == 0) throw InputError(options.config, "workers", "0: a worker has at least one solving process");
  config.metrics_port.reset();  // its owner's are of its slots, too
  return run<WorkerHost>(config);
}

// Runs a solving process. Results are written to stdout alone; whatever a library prints goes to stderr. The process
// ends with the service, because then there is nothing to solve.
int work(const WorkerSettings& settings) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int results = ::dup(STDOUT_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  solve_requests(STDIN_FILENO, results, settings);
  return 0;
}

}  // namespace

void add_serve(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ServeArguments>();
  CLI::App* command = app.add_subcommand("serve", "Plan for others: the planning service on DDS, until SIGTERM");
  command->add_option("--config", options->config, "Configuration; without it the defaults")->type_name("SERVICE.yaml");
  add_network_options(*command, options->network);
  command->add_option("--workers", options->workers, "Solving processes; 0: those of other machines alone")
      ->check(CLI::Range(0, 64));
  command->add_flag("--worker-only", options->worker_only,
                    "Solve for the service of the same robot_id on another machine, and answer nobody");
  command->add_option("--rehearse", options->rehearsal, "Wait for so many seconds in place of planning anything")
      ->check(positive())
      ->group("");  // to try out networks: every request ends as not converged
  command->callback([options, &exit_code] { exit_code = serve(*options); });
}

void add_worker(CLI::App& app, int& exit_code) {
  const auto settings = std::make_shared<WorkerSettings>();
  CLI::App* command = app.add_subcommand("worker", "One solving process of fjr serve, which starts it itself");
  command->group("");  // not for people
  command->add_option("--robot", settings->robot, "Robot file")->required();
  command->add_option("--warm-plans", settings->warm_plans, "Earlier plans to keep");
  command->add_option("--library", settings->library, "Folder of a plan library, to start from and to learn into");
  command->add_option("--jobs", settings->jobs, "Threads that a request is planned with");
  command->add_option("--rehearse", settings->rehearsal, "Seconds to wait in place of planning");
  command->callback([settings, &exit_code] { exit_code = work(*settings); });
}

}  // namespace fjr
