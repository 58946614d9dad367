// fjr plan: requests to certified trajectories.
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/say.h"
#include "common/strict_yaml.h"
#include "planner/library/plan_library.h"
#include "planner/ocp/collocate.h"
#include "planner/plan.h"
#include "planner/program/commands.h"
#include "planner/program/doubts.h"
#include "planner/program/interrupt.h"
#include "planner/program/plan_settings.h"
#include "planner/program/progress_line.h"
#include "planner/program/request_file.h"
#include "planner/program/result_files.h"
#include "planner/program/summary.h"
#include "planner/request/request.h"
#include "planner/request/request_keys.h"
#include "planner/results/explain_request.h"
#include "planner/results/plan_json.h"
#include "planner/results/report/plan_files.h"
#include "planner/results/result_folder.h"
#include "planner/results/solution_file.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

struct PlanArguments {
  std::vector<std::string> requests;
  std::string out;
  std::string robot;  // robot file for requests that name none; empty: the shipped one
  bool json = false;
  bool explain_only = false;
  Talk talk = Talk::kUsual;
  std::string warm;  // folder of an earlier plan
  PlanSettings settings;
  pid_t parent = 0;  // fjr batch; 0: none
};

struct PlanJob {
  std::string named;  // on the command line
  fs::path request;   // for messages
  fs::path folder;    // of its results
  std::optional<Problem> problem;
  std::optional<InputError> refusal;  // where there is no problem
  std::optional<WarmStart> warm;

  std::string name() const { return request.stem().string(); }
};

struct PlanOutcome {
  PlanStatus status;
  nlohmann::ordered_json json;
  std::string summary;  // for people; empty for a refusal, which went to stderr
};

std::vector<PlanJob> jobs_of(const PlanArguments& options) {
  std::vector<PlanJob> jobs;
  std::set<std::string> names;
  for (const std::string& request : options.requests) {
    PlanJob job{.named = request,
                .request = source_of(request),
                .folder = options.out,
                .problem = {},
                .refusal = {},
                .warm = {}};
    const std::string name = job.name();
    if (name.empty() || name == "." || name == "..") throw InputError("'" + request + "'", "", "is not a request file");
    if (options.requests.size() > 1 && name == kPrevious) {
      throw InputError(request, "", fmt::format("the folder {} in --out is for the results of an earlier run", name));
    }
    if (!names.insert(name).second) {
      throw InputError(request, "", "two requests named '" + name + "' would write the same files");
    }
    if (options.requests.size() > 1) job.folder /= name;
    jobs.push_back(std::move(job));
  }
  return jobs;
}

void complain(const std::string& problem) { say("fjr: {}\n", problem); }

// A library that cannot be opened is no fault of a request, so it is opened before any is read. Throws InputError.
std::optional<PlanLibrary> open_library(const PlanArguments& options) {
  if (options.settings.library.empty()) return std::nullopt;
  return PlanLibrary(options.settings.library, PlanLibrary::Access::kRead);
}

std::optional<WarmStart> warm_start(const Problem& problem, const PlanLibrary* library, const PlanArguments& options) {
  if (!options.warm.empty()) {
    const FolderLock lock(options.warm);
    Collocated solution = read_solution(fs::path(options.warm) / kSolutionFile, robot_hash(problem.robot));
    return WarmStart{std::make_shared<const Collocated>(std::move(solution)), options.warm};
  }
  if (library == nullptr) return std::nullopt;
  try {
    const auto neighbour = library->nearest(problem);
    return neighbour ? std::optional(warm_start_from(*neighbour)) : std::nullopt;
  } catch (const InputError& damaged) {  // an entry of the library is damaged: the request is planned without it
    complain(fmt::format("{}: planned from scratch, for the nearest plan cannot be read: {}", options.settings.library,
                         damaged.what()));
    return std::nullopt;
  }
}

void load(PlanJob& job, const PlanLibrary* library, const PlanArguments& options) {
  try {
    Problem problem = resolve_named(read_named(job.named), options.robot).problem;
    job.warm = warm_start(problem, library, options);
    job.problem = std::move(problem);
  } catch (const InputError& error) {
    job.refusal = error;
  }
}

bool has_earlier_results(const PlanJob& job) {
  const FolderLock lock(job.folder);
  return value_of_results(job.folder) != ResultValue::kNothing;
}

// A refused request does not replace earlier results.
PlanOutcome refuse(const PlanJob& job, nlohmann::ordered_json json) {
  PlanOutcome outcome{PlanStatus::kBadInput, std::move(json), ""};
  if (has_earlier_results(job)) return outcome;
  NewResults results(job.folder);
  write_file(results.stage() / "plan.json", json_text(outcome.json));
  results.publish();
  return outcome;
}

PlanOutcome refuse_unread(const PlanJob& job) {
  return refuse(job, bad_input_json(job.name(), job.refusal->what(), job.refusal->field()));
}

Plan solve(const PlanJob& job, const PlanArguments& options) {
  ProgressLine line(job.name(), options.talk);
  PlanOptions plan_options = options.settings.plan;
  plan_options.on_progress = [&line](const Progress& progress) { line.show(progress); };
  plan_options.cancelled = interrupted;
  plan_options.warm = job.warm;
  return plan(*job.problem, plan_options);
}

PlanOutcome store(const PlanJob& job, const PlanArguments& options, Plan& result) {
  NewResults results(job.folder);
  PlanOutcome outcome{result.status, plan_json(*job.problem, result), summary(*job.problem, result)};
  if (result.trajectory) describe(*result.trajectory, outcome.json);
  const PlanFiles files{outcome.json, result.trajectory ? &*result.trajectory : nullptr, result.solution.get()};
  std::vector<std::string> written = write_plan_files(files, results.stage(), options.settings.keep_uncertified);
  std::exception_ptr no_report;
  try {
    if (options.settings.report) written.push_back(write_report(results.stage()).filename().string());
  } catch (...) {  // the plan is stored all the same
    no_report = std::current_exception();
  }
  const bool kept = results.publish();
  if (no_report) std::rethrow_exception(no_report);
  for (std::string& name : written) name = (job.folder / name).string();
  outcome.summary += fmt::format("  {:<11} {}\n", "files", fmt::join(written, ", "));
  const std::string before = about_previous(job.folder, result.status, kept);
  if (!before.empty()) outcome.summary += fmt::format("  {:<11} {}\n", "previous", before);
  if (!before.empty() && options.json) complain(before);
  return outcome;
}

// Plans a job. A contradiction that is found only while planning is reported on stderr like the others.
PlanOutcome make_plan(const PlanJob& job, const PlanArguments& options) {
  Plan result;
  if (interrupted()) {
    result.status = PlanStatus::kCancelled;
    result.reason = "interrupted before it was started";
    if (has_earlier_results(job))
      return {result.status, plan_json(*job.problem, result), summary(*job.problem, result)};
  } else {
    result = solve(job, options);
  }
  if (result.status == PlanStatus::kBadInput) {
    complain(job.request.string() + ": " + result.reason);
    PlanOutcome outcome = refuse(job, plan_json(*job.problem, result));
    outcome.summary = summary(*job.problem, result);
    return outcome;
  }
  return store(job, options, result);
}

void print_json(std::vector<PlanOutcome>& outcomes) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (PlanOutcome& outcome : outcomes) all.push_back(std::move(outcome.json));
  fmt::print("{}", json_text(outcomes.size() == 1 ? all.front() : all));
}

// Makes this process end with its parent, in whatever way that ends. Returns true if the parent is gone already.
bool orphaned(pid_t parent) {
  if (parent == 0) return false;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  return ::getppid() != parent;
}

// Explains how requests are understood, without planning. Refusals are reported as before planning.
int explain(const PlanArguments& options) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::string& named : options.requests) {
    const NamedRequest request = read_named(named);
    const ResolvedRequest resolved = resolve_named(request, options.robot);
    const auto keys = understood(request.document, resolved.problem, resolved.robot.string());
    if (!options.json) fmt::print("{}", explanation_of_request(resolved.problem.name, keys));
    all.push_back(explanation_json(resolved.problem.name, keys));
  }
  if (options.json) fmt::print("{}", json_text(all.size() == 1 ? all.front() : all));
  return 0;
}

int run(const PlanArguments& options) {
  if (options.explain_only) return explain(options);
  if (options.out.empty()) throw InputError("command line", "", "--out is required (see --help)");
  if (orphaned(options.parent)) return exit_code(PlanStatus::kCancelled);
  catch_interrupts();
  std::vector<PlanJob> jobs = jobs_of(options);
  const std::optional<PlanLibrary> library = open_library(options);
  for (PlanJob& job : jobs) {  // a mistake in the last request is told at once, not after the first is solved
    load(job, library ? &*library : nullptr, options);
    if (!job.problem) complain(job.refusal->what());
    if (job.problem && options.parent == 0) tell_doubts(job.problem->robot);
  }
  for (const PlanJob& job : jobs) prepare_folder(job.folder);
  std::vector<PlanOutcome> outcomes;
  int code = 0;
  for (const PlanJob& job : jobs) {
    outcomes.push_back(job.problem ? make_plan(job, options) : refuse_unread(job));
    code = std::max(code, exit_code(outcomes.back().status));
    if (!options.json) say_in(stdout, "{}", outcomes.back().summary);
    std::fflush(stdout);
  }
  if (options.json) {
    print_json(outcomes);
  } else if (outcomes.size() > 1) {
    const auto certified = std::count_if(outcomes.begin(), outcomes.end(),
                                         [](const PlanOutcome& o) { return o.status == PlanStatus::kCertified; });
    fmt::print("{} of {} certified\n", certified, outcomes.size());
  }
  return code;
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<PlanArguments>();
  CLI::App* command = app.add_subcommand("plan", "Plan requests and write certified trajectories");
  command->add_option("requests", options->requests, "Request files, or - for standard input")
      ->required()
      ->type_name("REQUEST.yaml|-");
  command->add_option("--out", options->out, "Folder of the results; of several requests each gets a folder in it")
      ->type_name("DIR");
  command->add_flag("--explain-request", options->explain_only,
                    "Plan nothing, write nothing: say what is asked for, with every default that applies");
  command->add_option("--robot", options->robot, "robot.yaml for requests that name none; default: the shipped one")
      ->type_name("ROBOT.yaml");
  command->add_flag("--json", options->json, "Only JSON on stdout: plan.json, an array of them for several requests");
  command
      ->add_option(
          "--warm", options->warm,
          "Folder of an earlier plan of a similar request: its solution is the start, and the plan if that can be "
          "certified")
      ->type_name("DIR");
  options->settings.plan.jobs = 0;
  command
      ->add_option("--jobs", options->settings.plan.jobs,
                   "Threads that a request is planned with; the plan does not depend on it. 0: as many as cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  add_options(*command, options->settings);
  command->get_option("--library")->excludes("--warm");
  add_report_option(*command, options->settings);
  add_settings_option(*command, options->settings);
  add_talk(*command, options->talk);
  command->add_option("--parent", options->parent, "Process without which there is nothing to plan for")->group("");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
