// fjr library: plans that are kept for requests beside them to start from (planner/library/plan_library.h).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/atomic_file.h"
#include "common/cpu_time.h"
#include "common/input_error.h"
#include "common/say.h"
#include "common/strict_yaml.h"
#include "planner/batch/items.h"
#include "planner/batch/statuses.h"
#include "planner/library/plan_library.h"
#include "planner/ocp/collocate.h"
#include "planner/program/commands.h"
#include "planner/program/doubts.h"
#include "planner/program/ending.h"
#include "planner/program/interrupt.h"
#include "planner/program/number_checks.h"
#include "planner/program/plan_pool.h"
#include "planner/program/plan_settings.h"
#include "planner/program/progress_line.h"
#include "planner/program/scratch.h"
#include "planner/request/request.h"
#include "planner/request/request_keys.h"
#include "planner/results/plan_json.h"
#include "planner/results/solution_file.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct LibraryArguments {
  std::vector<std::string> requests;
  std::string folder;
  std::size_t jobs = std::max(1U, std::thread::hardware_concurrency());
  bool json = false;
  Talk talk = Talk::kUsual;
  PlanSettings settings;
  // fjr library check
  std::string robot;
  std::size_t sample = 20;
  double away = 0.5 * kNearby;  // [rad]
  double tolerance = 0.01;      // fraction of the objective
  std::uint64_t seed = 1;
};

// ---- build ----

struct LibraryItem {
  BatchItem item;
  std::string request;  // YAML that stands by itself
  std::optional<Problem> problem;
};

class LibraryBuild {
 public:
  explicit LibraryBuild(const LibraryArguments& options)
      : options_(options), library_(options.folder, PlanLibrary::Access::kWrite) {}

  bool run() {  // false: interrupted
    const std::vector<std::size_t> open = sort_out();
    catch_ending_signals();
    ProgressLine line("library", options_.talk);
    const PlanPool pool{
        options_.jobs, [&](std::size_t i) { return begin(items_[i]); },
        [&](std::size_t i, const PlanEnding& ending, bool interrupted) { end(items_[i], ending, interrupted); }};
    return !pool.plan(open, line).interrupted;
  }

  std::string for_people() const {
    std::string text = fmt::format("{} request{}: {} in the library before, {} added\n", items_.size(),
                                   items_.size() == 1 ? "" : "s", before_, added_);
    if (without_family_ > 0) {
      text += fmt::format(
          "{} not kept: plans are looked up by the joint angles of start and goal, which these leave "
          "open\n",
          without_family_);
    }
    return text + statuses_.for_people();
  }
  Json to_json() const {
    return {{"requests", items_.size()},
            {"before", before_},
            {"added", added_},
            {"without_family", without_family_},
            {"status", statuses_.to_json()}};
  }
  int exit_code() const { return statuses_.exit_code(); }

 private:
  std::vector<std::size_t> sort_out() {
    std::vector<BatchItem> given = collect_items(options_.requests, options_.folder);
    check_default_robot(given);
    std::vector<std::size_t> open;
    for (BatchItem& item : given) {
      items_.push_back({std::move(item), "", std::nullopt});
      LibraryItem& added = items_.back();
      try {
        added.request = text_of(added.item);
        added.problem = load(added.item);
        tell_doubts(added.problem->robot);
      } catch (const InputError& error) {
        say("fjr: {}\n", error.what());
        statuses_.add(name(PlanStatus::kBadInput));
        continue;
      }
      if (!family_of(*added.problem)) {
        ++without_family_;
      } else if (library_.has(*added.problem)) {
        ++before_;
      } else {
        open.push_back(items_.size() - 1);
      }
    }
    return open;
  }

  std::vector<std::string> begin(const LibraryItem& item) const {
    const std::string& name = item.item.name;
    write_file(scratch_.request(name), item.request);
    std::vector<std::string> words = to_arguments(options_.settings);
    words.insert(words.end(),
                 {"--jobs", "1", "--out", scratch_.results(name).string(), "--", scratch_.request(name).string()});
    return words;
  }

  void end(const LibraryItem& item, const PlanEnding& ending, bool interrupted) {
    const Row row = row_at_end(item.item, ending, interrupted);
    const std::string status = row["status"].get<std::string>();
    statuses_.add(status);
    if (status == name(PlanStatus::kCertified)) {
      const fs::path file = scratch_.results(item.item.name) / kSolutionFile;
      const auto plan = Json::parse(ending.plan_json);
      library_.add(*item.problem, item.request, plan.at("objective").at("total").get<double>(),
                   read_solution(file, robot_hash(item.problem->robot)));
      ++added_;
    }
    scratch_.clear(item.item.name);
  }

  const LibraryArguments& options_;
  PlanLibrary library_;
  std::vector<LibraryItem> items_;
  Scratch scratch_;
  StatusCounts statuses_;
  std::size_t before_ = 0, added_ = 0, without_family_ = 0;
};

int build(const LibraryArguments& options) {
  LibraryBuild build(options);
  const bool complete = build.run();
  fmt::print("{}", options.json ? json_text(build.to_json()) : build.for_people());
  return complete ? build.exit_code() : exit_code(PlanStatus::kCancelled);
}

// ---- status ----

Json range_json(const Joints<double>& from, const Joints<double>& to) {
  return Json::array({Json::array({from[0], to[0]}), Json::array({from[1], to[1]})});
}

std::string range_text(const Joints<double>& from, const Joints<double>& to) {
  return fmt::format("{:.4g} to {:.4g}, {:.4g} to {:.4g}", from[0], to[0], from[1], to[1]);
}

int tell_status(const LibraryArguments& options) {
  const PlanLibrary library(options.folder, PlanLibrary::Access::kRead);
  Json json = Json::array();
  for (const LibraryFamily& f : library.families()) {
    json.push_back({{"family", f.id},
                    {"robot_hash", f.robot_hash},
                    {"plans", f.plans},
                    {"start_rad", range_json(f.start_from, f.start_to)},
                    {"goal_rad", range_json(f.goal_from, f.goal_to)}});
    if (options.json) continue;
    fmt::print("{} plan{} of family {} (robot {})\n  start {} rad\n  goal  {} rad\n", f.plans, f.plans == 1 ? "" : "s",
               f.id.substr(0, 12), f.robot_hash.substr(0, 12), range_text(f.start_from, f.start_to),
               range_text(f.goal_from, f.goal_to));
  }
  if (options.json) {
    fmt::print("{}", json_text(json));
  } else if (json.empty()) {
    fmt::print("no plans\n");
  }
  return 0;
}

// ---- check ----

// A request near a plan of the library, planned from that plan and from scratch.
struct LibraryCheck {
  std::string name;  // of the plan
  bool used = false;
  std::optional<std::string> refusal;
  double objective = 0, cold_objective = 0;
  int iterations = 0, cold_iterations = 0;
  double cpu = 0, cold_cpu = 0;  // [s]

  double excess() const { return (objective - cold_objective) / std::max(std::abs(cold_objective), 1e-300); }
};

// Returns the problem with the goal moved by `away` [rad] in the direction `angle`; nothing if that is not allowed.
std::optional<Problem> moved(const LibraryEntry& entry, double away, double angle, const LibraryArguments& options) {
  Request request = read_request(YamlNode::parse(entry.request, entry.name));
  request.goal = JointGoal{{entry.goal[0] + away * std::cos(angle), entry.goal[1] + away * std::sin(angle)}, AtRest{}};
  const Parameters robot = load_parameters(robot_file_of(request, {}, options.robot));
  try {
    return resolve(request, robot);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::optional<LibraryCheck> check_one(const PlanLibrary& library, const LibraryEntry& entry, double angle,
                                      const LibraryArguments& options) {
  const auto problem = moved(entry, options.away, angle, options);
  const auto neighbour = problem ? library.nearest(*problem) : std::nullopt;
  if (!neighbour) return std::nullopt;
  PlanOptions plan_options = options.settings.plan;
  plan_options.cancelled = interrupted;
  LibraryCheck check;
  check.name = entry.name;
  double began = cpu_time();
  const Plan cold = plan(*problem, plan_options);
  check.cold_cpu = cpu_since(began);
  plan_options.warm = warm_start_from(*neighbour);
  began = cpu_time();
  const Plan warm = plan(*problem, plan_options);
  check.cpu = cpu_since(began);
  if (interrupted() || cold.status != PlanStatus::kCertified) return std::nullopt;
  check.used = warm.warm;
  check.refusal = warm.warm_refusal;
  check.objective = warm.objective;
  check.cold_objective = cold.objective;
  check.iterations = warm.iterations;
  check.cold_iterations = cold.iterations;
  return check;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct CheckSummary {
  std::size_t used = 0;
  double worst = 0, median_cpu = 0, median_cold_cpu = 0;
};

CheckSummary sum_up(const std::vector<LibraryCheck>& checks) {
  CheckSummary sum;
  std::vector<double> cpu, cold;
  for (const LibraryCheck& check : checks) {
    cpu.push_back(check.cpu);
    cold.push_back(check.cold_cpu);
    if (!check.used) continue;
    ++sum.used;
    sum.worst = std::max(sum.worst, check.excess());
  }
  sum.median_cpu = median(cpu);
  sum.median_cold_cpu = median(cold);
  return sum;
}

Json to_json(const std::vector<LibraryCheck>& checks) {
  Json rows = Json::array();
  for (const LibraryCheck& c : checks) {
    rows.push_back({{"plan", c.name},
                    {"used", c.used},
                    {"reason", c.refusal ? Json(*c.refusal) : Json(nullptr)},
                    {"objective", c.objective},
                    {"objective_from_scratch", c.cold_objective},
                    {"iterations", c.iterations},
                    {"iterations_from_scratch", c.cold_iterations},
                    {"cpu_s", c.cpu},
                    {"cpu_from_scratch_s", c.cold_cpu}});
  }
  const CheckSummary sum = sum_up(checks);
  return {{"checked", checks.size()}, {"used", sum.used}, {"worst_excess", sum.worst}, {"requests", std::move(rows)}};
}

std::string for_people(const std::vector<LibraryCheck>& checks, double away) {
  const CheckSummary sum = sum_up(checks);
  return fmt::format(
      "{} request{} {:.3g} rad beside plans of the library\n"
      "  planned from there   {} of {}\n"
      "  objective            at most {:.2g} % above that from scratch\n"
      "  CPU time             {:.3f} s in place of {:.3f} s (medians)\n",
      checks.size(), checks.size() == 1 ? "" : "s", away, sum.used, checks.size(), 100 * sum.worst, sum.median_cpu,
      sum.median_cold_cpu);
}

int check(const LibraryArguments& options) {
  const PlanLibrary library(options.folder, PlanLibrary::Access::kRead);
  catch_interrupts();
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> any_angle(0, 2 * std::numbers::pi);
  const std::vector<LibraryEntry> entries = library.sample(options.sample, options.seed);
  std::vector<LibraryCheck> checks;
  {
    ProgressLine line("library", options.talk);
    for (std::size_t i = 0; i < entries.size() && !interrupted(); ++i) {
      line.show(fmt::format("{} of {} checked", i, entries.size()));
      if (auto done = check_one(library, entries[i], any_angle(random), options)) checks.push_back(std::move(*done));
    }
  }
  if (interrupted()) return exit_code(PlanStatus::kCancelled);
  if (checks.empty()) throw InputError(options.folder, "", "holds nothing that could be checked");
  fmt::print("{}", options.json ? json_text(to_json(checks)) : for_people(checks, options.away));
  return sum_up(checks).worst <= options.tolerance ? 0 : 1;
}

// ---- command line ----

void add_build(CLI::App& library, LibraryArguments& options) {
  CLI::App* command = library.add_subcommand(
      "build", "Plan requests, or grids of them, and keep the certified plans; what is there already is not planned");
  command->add_option("requests", options.requests, "Request files, grids of requests, folders with either")
      ->required()
      ->type_name("REQUESTS");
  command->add_option("--out", options.folder, "Folder of the library")->required()->type_name("DIR");
  command->add_option("--jobs", options.jobs, "Requests planned at a time; default: the number of cores")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command->add_flag("--json", options.json, "Only JSON on stdout");
  add_options(*command, options.settings);
  add_talk(*command, options.talk);
}

void add_check(CLI::App& library, LibraryArguments& options) {
  CLI::App* command = library.add_subcommand(
      "check", "Plan requests beside some of the plans, from there and from scratch, and compare the objectives");
  command->add_option("folder", options.folder, "Folder of the library")->required()->type_name("DIR");
  command->add_option("--sample", options.sample, "Plans to check, drawn at random")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--away", options.away, "How far their goals are moved, in rad")
      ->check(between(0, kNearby))
      ->capture_default_str()
      ->type_name("RAD");
  command
      ->add_option("--tolerance", options.tolerance, "Fraction of the objective that may be lost: exit code 1 beyond")
      ->check(between(0, 1))
      ->capture_default_str()
      ->type_name("X");
  command->add_option("--seed", options.seed, "Of the sample and of the directions")
      ->check(seed())
      ->capture_default_str();
  command->add_option("--robot", options.robot, "robot.yaml for requests that name none; default: the shipped one")
      ->type_name("ROBOT.yaml");
  command->add_flag("--json", options.json, "Only JSON on stdout");
  add_talk(*command, options.talk);
}

void add_library_status(CLI::App& library, LibraryArguments& options) {
  CLI::App* command = library.add_subcommand("status", "What the library holds, family by family");
  command->add_option("folder", options.folder, "Folder of the library")->required()->type_name("DIR");
  command->add_flag("--json", options.json, "Only JSON on stdout");
}

}  // namespace

void add_library(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<LibraryArguments>();
  CLI::App* library = app.add_subcommand("library", "Keep plans that requests beside them start from");
  library->require_subcommand(1);
  add_build(*library, *options);
  add_check(*library, *options);
  add_library_status(*library, *options);
  const auto does = [&](const char* name, int (*function)(const LibraryArguments&)) {
    library->get_subcommand(name)->callback([options, function, &exit_code] { exit_code = function(*options); });
  };
  does("build", build);
  does("check", check);
  does("status", tell_status);
}

}  // namespace fjr
