// fjr serve: the planning service on DDS; fjr worker: one of its solving processes.
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <thread>

#include "planner/program/commands.h"
#include "planner/program/ending.h"
#include "planner/program/network_arguments.h"
#include "planner/program/service_log.h"
#include "planner/service/service.h"
#include "planner/service/solve_loop.h"

namespace fjr {
namespace {

struct ServeArguments {
  std::string config;
  NetworkArguments network;
  int workers = 0;  // 0: as configured
};

int serve(const ServeArguments& options) {
  catch_ending_signals();  // before any other thread is started
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of whoever writes it
  const auto log = log_to_stderr();
  ServiceConfig config = options.config.empty() ? default_service_config() : load_service_config(options.config);
  options.network.apply_to(config.network);
  if (options.workers > 0) config.workers = static_cast<std::size_t>(options.workers);
  Service service(config);
  const std::jthread ending = stop_at_end(service);
  service.run();
  return 0;
}

// Results have stdout for themselves; whatever a library prints goes to stderr. Without the service there is nothing to
// solve for.
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
  command->add_option("--workers", options->workers, "Solving processes")->check(CLI::Range(1, 64));
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
  command->callback([settings, &exit_code] { exit_code = work(*settings); });
}

}  // namespace fjr
