// fjr batch: many requests, each planned by a process of its own; what is finished is not planned again.
#include <fmt/format.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "planner/batch/earlier.h"
#include "planner/batch/items.h"
#include "planner/batch/table.h"
#include "planner/program/commands.h"
#include "planner/program/doubts.h"
#include "planner/program/ending.h"
#include "planner/program/plan_process.h"
#include "planner/program/plan_settings.h"
#include "planner/program/progress_line.h"
#include "planner/program/result_files.h"
#include "planner/results/plan_json.h"
#include "planner/results/report/plan_files.h"
#include "planner/results/result_folder.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxComplaints = 10;   // shown; all of them are in the summary
constexpr const char* kFailed = "failed";    // no plan.json: a crash, a full disk
constexpr timespec kRedraw{0, 500'000'000};  // of the progress line while nothing happens

struct BatchArguments {
  std::vector<std::string> requests;
  std::string out, shard;
  std::size_t jobs = std::max(1U, std::thread::hardware_concurrency());
  bool json = false;
  Talk talk = Talk::kUsual;
  PlanSettings settings;
};

struct Batch {
  const BatchArguments& options;
  std::vector<BatchItem> items;
  std::vector<Row> rows;  // beside the items
  std::size_t earlier = 0, planned = 0;

  fs::path folder(const BatchItem& item) const { return fs::path(options.out) / item.name; }
};

void complain(const std::vector<std::string>& complaints) {
  for (std::size_t i = 0; i < std::min(complaints.size(), kMaxComplaints); ++i) {
    fmt::print(stderr, "fjr: {}\n", complaints[i]);
  }
  if (complaints.size() <= kMaxComplaints) return;
  fmt::print(stderr, "fjr: {} more bad requests are in the summary\n", complaints.size() - kMaxComplaints);
}

// The folder, with the request of a point of a grid.
void begin(const Batch& batch, const BatchItem& item) {
  prepare_folder(batch.folder(item));
  if (item.yaml) write_file(item.request, *item.yaml);
}

// Results of an earlier request are left as they are.
Row refuse(const Batch& batch, const BatchItem& item, const InputError& error) {
  const fs::path folder = batch.folder(item);
  const Json plan = bad_input_json(item.name, error.what(), error.field());
  {
    const FolderLock lock(folder);
    if (worth_of(folder) != Worth::kNothing) return make_row(item, plan);
  }
  begin(batch, item);
  NewResults results(folder);
  write_file(results.stage() / "plan.json", json_text(plan));
  results.publish();
  return make_row(item, plan);
}

// To what was finished without one.
void complete_report(const Batch& batch, const BatchItem& item, const Json& plan) {
  const bool wanted = batch.options.settings.report && plan["status"] != name(PlanStatus::kBadInput);
  if (wanted && !has_report(batch.folder(item))) write_report(batch.folder(item));
}

// Rows of what an earlier run has finished and of bad requests; returns which items are left to be planned.
std::vector<std::size_t> sort_out(Batch& batch) {
  std::vector<std::size_t> open;
  std::vector<std::string> complaints;
  {
    ProgressLine line("looking for what is finished", batch.options.talk);
    for (std::size_t i = 0; i < batch.items.size(); ++i) {
      line.show(static_cast<double>(i) / static_cast<double>(batch.items.size()));
      const BatchItem& item = batch.items[i];
      std::optional<Problem> problem;
      try {
        problem = load(item);
      } catch (const InputError& error) {
        complaints.emplace_back(error.what());
        batch.rows[i] = refuse(batch, item, error);
        continue;
      }
      tell_doubts(problem->robot);
      const FolderLock lock(batch.folder(item));
      const auto plan = finished_earlier(*problem, batch.folder(item), batch.options.settings.keep_uncertified,
                                         batch.options.settings.plan.proven);
      if (plan) {
        complete_report(batch, item, *plan);
        batch.rows[i] = make_row(item, *plan);
        ++batch.earlier;
      } else {
        open.push_back(i);
      }
    }
  }
  complain(complaints);
  return open;
}

// ---- planning ----

struct Running {
  std::size_t item;
  PlanProcess process;
};

void start(Batch& batch, std::size_t index, std::vector<Running>& running) {
  const BatchItem& item = batch.items[index];
  try {
    begin(batch, item);
    std::vector<std::string> arguments = to_arguments(batch.options.settings);
    arguments.insert(arguments.end(),
                     {"--jobs", "1", "--out", batch.folder(item).string(), "--", item.request.string()});
    running.push_back({index, PlanProcess(std::move(arguments))});
  } catch (const std::exception& error) {
    batch.rows[index] = make_row(item, kFailed, error.what());
  }
}

// By what the process said: its folder may hold earlier results.
Row row_at_end(const BatchItem& item, const PlanEnding& ending, bool interrupted) {
  const Json plan = Json::parse(ending.plan_json, nullptr, false);
  if (plan.is_object() && plan.contains("status")) return make_row(item, plan);
  if (interrupted) return make_row(item, name(PlanStatus::kCancelled), "interrupted");
  return make_row(item, kFailed, ending.words);
}

void reap(Batch& batch, std::vector<Running>& running, bool interrupted) {
  std::erase_if(running, [&](Running& run) {
    const auto ending = run.process.ending();
    if (ending) {
      batch.rows[run.item] = row_at_end(batch.items[run.item], *ending, interrupted);
      ++batch.planned;
    }
    return ending.has_value();
  });
}

// The time that is left is estimated from the mean of the finished requests; those under way count as half finished.
std::string progress(std::size_t done, std::size_t all, std::size_t running, Clock::time_point began) {
  const double elapsed = std::chrono::duration<double>(Clock::now() - began).count();
  const double behind = static_cast<double>(done) + static_cast<double>(running) / 2;
  std::string text = fmt::format("{} of {} planned, {} under way", done, all, running);
  if (done > 0)
    text += fmt::format(", about {} left", time_in_words(elapsed * (static_cast<double>(all) / behind - 1)));
  return text;
}

// At the first SIGINT or SIGTERM nothing more is started and what is under way is cancelled; at the next it is killed.
void plan_all(Batch& batch, const std::vector<std::size_t>& open) {
  catch_ending_signals();
  sigset_t child_ended;
  sigemptyset(&child_ended);
  sigaddset(&child_ended, SIGCHLD);
  ::signal(SIGCHLD, SIG_DFL);
  ::pthread_sigmask(SIG_BLOCK, &child_ended, nullptr);
  ProgressLine line("batch", batch.options.talk);
  const Clock::time_point began = Clock::now();
  std::vector<Running> running;
  auto next = open.begin();
  for (int interruptions = 0;;) {
    while (interruptions == 0 && next != open.end() && running.size() < batch.options.jobs) {
      start(batch, *next++, running);
    }
    if (running.empty()) break;
    line.show(progress(batch.planned, open.size(), running.size(), began));
    ::sigtimedwait(&child_ended, nullptr, &kRedraw);
    if (ending_signalled()) {
      ++interruptions;
      for (const Running& run : running) interruptions == 1 ? run.process.cancel() : run.process.kill();
    }
    reap(batch, running, interruptions > 0);
  }
  for (; next != open.end(); ++next) {
    batch.rows[*next] = make_row(batch.items[*next], name(PlanStatus::kCancelled), "interrupted before it was started");
  }
}

// ---- summary ----

constexpr std::array kStatuses = {PlanStatus::kCertified,   PlanStatus::kInfeasible, PlanStatus::kNotConverged,
                                  PlanStatus::kUncertified, PlanStatus::kBadInput,   PlanStatus::kDeadline,
                                  PlanStatus::kCancelled};

int exit_code_of(const Row& row) {
  const auto status = std::find_if(kStatuses.begin(), kStatuses.end(),
                                   [&](PlanStatus candidate) { return row["status"] == name(candidate); });
  return status == kStatuses.end() ? 1 : exit_code(*status);
}

// How many rows there are of each status that occurs.
Json count_statuses(const std::vector<Row>& rows) {
  Json counts = Json::object();
  const auto count = [&](const char* status) {
    const auto number =
        std::count_if(rows.begin(), rows.end(), [&](const Row& row) { return row["status"] == status; });
    if (number > 0) counts[status] = number;
  };
  for (const PlanStatus status : kStatuses) count(name(status));
  count(kFailed);
  return counts;
}

Json summary_json(const Batch& batch) {
  return {{"version", FJR_VERSION},
          {"shard", batch.options.shard.empty() ? Json(nullptr) : Json(batch.options.shard)},
          {"requests", batch.rows.size()},
          {"status", count_statuses(batch.rows)},
          {"planned", batch.planned},
          {"finished_earlier", batch.earlier},
          {"units", table_units()},
          {"rows", batch.rows}};
}

std::string for_people(const Batch& batch, const Json& summary, const std::string& files) {
  std::string text = fmt::format("{} request{}, {} planned now, {} finished earlier\n", batch.rows.size(),
                                 batch.rows.size() == 1 ? "" : "s", batch.planned, batch.earlier);
  for (const auto& [status, count] : summary["status"].items()) {
    text += fmt::format("  {:<14} {}\n", status, count.get<std::size_t>());
  }
  return text + fmt::format("  {:<14} {}\n", "files", files);
}

int tell(const Batch& batch, const std::optional<Shard>& shard) {
  const std::string part = shard ? fmt::format(".{}-of-{}", shard->index, shard->count) : "";
  const fs::path csv = fs::path(batch.options.out) / fmt::format("summary{}.csv", part);
  const fs::path json = fs::path(batch.options.out) / fmt::format("summary{}.json", part);
  const Json summary = summary_json(batch);
  write_file(csv, table_csv(batch.rows));
  write_file(json, json_text(summary));
  fmt::print("{}",
             batch.options.json ? json_text(summary) : for_people(batch, summary, csv.string() + ", " + json.string()));
  int code = 0;
  for (const Row& row : batch.rows) code = std::max(code, exit_code_of(row));
  return code;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError("--out", "", fmt::format("cannot make folder {}: {}", folder.string(), error.message()));
}

int run(const BatchArguments& options) {
  std::optional<Shard> shard;
  if (!options.shard.empty()) shard = parse_shard(options.shard);
  Batch batch{options, collect_items(options.requests, options.out), {}};
  if (shard) batch.items = shard_of(std::move(batch.items), *shard);
  batch.rows.resize(batch.items.size());
  check_default_robot(batch.items);
  make_folder(options.out);
  plan_all(batch, sort_out(batch));
  return tell(batch, shard);
}

}  // namespace

void add_batch(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<BatchArguments>();
  CLI::App* command = app.add_subcommand(
      "batch", "Plan many requests in parallel; run again after an interruption, it plans what is not finished");
  command
      ->add_option("requests", options->requests,
                   "Request files, grids of requests (config/batch/reach_grid.yaml), folders with either")
      ->required()
      ->type_name("REQUESTS");
  command
      ->add_option("--out", options->out,
                   "Folder of the results: one folder for each request, summary.csv and summary.json. A request is "
                   "finished when its folder has the result of the same request, robot and version of fjr, whatever "
                   "the options were; a deadline or a cancellation is no result")
      ->required()
      ->type_name("DIR");
  command->add_option("--jobs", options->jobs, "Requests planned at a time; default: the number of cores")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command
      ->add_option("--shard", options->shard,
                   "Plan the I-th of N parts only, with a summary of its own (summary.I-of-N.csv, .json); parts may "
                   "run at the same time, on several machines too. Without --shard afterwards: the whole summary")
      ->type_name("I/N");
  command->add_flag("--json", options->json, "Only JSON on stdout: the summary");
  add_options(*command, options->settings);
  add_talk(*command, options->talk);
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
