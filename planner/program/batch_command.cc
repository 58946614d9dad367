// fjr batch: many requests, each planned by a process of its own; what is finished is not planned again.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
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
#include "common/say.h"
#include "planner/batch/earlier.h"
#include "planner/batch/items.h"
#include "planner/batch/statuses.h"
#include "planner/batch/table.h"
#include "planner/program/commands.h"
#include "planner/program/doubts.h"
#include "planner/program/ending.h"
#include "planner/program/packed_batch.h"
#include "planner/program/plan_pool.h"
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

constexpr std::size_t kMaxComplaints = 10;  // number shown; all of them are in the summary

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
    say("fjr: {}\n", complaints[i]);
  }
  if (complaints.size() <= kMaxComplaints) return;
  say("fjr: {} more bad requests are in the summary\n", complaints.size() - kMaxComplaints);
}

// Makes the folder of an item, and writes the request if it is a point of a grid.
void begin(const Batch& batch, const BatchItem& item) {
  prepare_folder(batch.folder(item));
  if (item.yaml) write_file(item.request, *item.yaml);
}

// Makes the row of a refused request. Results of an earlier request are left as they are.
Row refuse(const Batch& batch, const BatchItem& item, const InputError& error) {
  const fs::path folder = batch.folder(item);
  const Json plan = bad_input_json(item.name, error.what(), error.field());
  {
    const FolderLock lock(folder);
    if (value_of_results(folder) != ResultValue::kNothing) return make_row(item, plan);
  }
  begin(batch, item);
  NewResults results(folder);
  write_file(results.stage() / "plan.json", json_text(plan));
  results.publish();
  return make_row(item, plan);
}

// Adds a report to a plan that was finished without one. If that fails, only this report is missing.
void complete_report(const Batch& batch, const BatchItem& item, const Json& plan) {
  const bool wanted = batch.options.settings.report && plan["status"] != name(PlanStatus::kBadInput);
  if (!wanted || has_report(batch.folder(item))) return;
  try {
    write_report(batch.folder(item));
  } catch (const std::exception& error) {
    say("fjr: {} has no report: {}\n", item.name, error.what());
  }
}

// Returns the row of an item that an earlier run finished; nothing if it has to be planned. Files that cannot be read
// as a plan do not count as a result.
std::optional<Row> row_of_earlier(const Batch& batch, const BatchItem& item, const Problem& problem) {
  const PlanSettings& settings = batch.options.settings;
  const FolderLock lock(batch.folder(item));
  try {
    const auto plan = finished_earlier(problem, files_in(batch.folder(item)), settings.keep_uncertified,
                                       settings.plan.proven, settings.plan.search);
    if (!plan) return std::nullopt;
    complete_report(batch, item, *plan);
    return make_row(item, *plan);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

// Makes the rows of items that an earlier run has finished and of bad requests. Returns which items have to be planned.
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
      if (auto row = row_of_earlier(batch, item, *problem)) {
        batch.rows[i] = *std::move(row);
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

std::vector<std::string> begin_planning(const Batch& batch, std::size_t index) {
  const BatchItem& item = batch.items[index];
  begin(batch, item);
  std::vector<std::string> words = to_arguments(batch.options.settings);
  words.insert(words.end(), {"--jobs", "1", "--out", batch.folder(item).string(), "--", item.request.string()});
  return words;
}

void plan_all(Batch& batch, const std::vector<std::size_t>& open) {
  const PlanPool pool{batch.options.jobs, [&](std::size_t index) { return begin_planning(batch, index); },
                      [&](std::size_t index, const PlanEnding& ending, bool interrupted) {
                        batch.rows[index] = row_at_end(batch.items[index], ending, interrupted);
                        ++batch.planned;
                      }};
  catch_ending_signals();
  ProgressLine line("batch", batch.options.talk);
  for (const std::size_t index : pool.plan(open, line).not_started) {
    batch.rows[index] = make_row(batch.items[index], name(PlanStatus::kCancelled), "interrupted before it was started");
  }
}

// ---- summary ----

StatusCounts count_statuses(const std::vector<Row>& rows) {
  StatusCounts counts;
  for (const Row& row : rows) counts.add(row["status"]);
  return counts;
}

Json summary_json(const Batch& batch) {
  return {{"version", FJR_VERSION},
          {"shard", batch.options.shard.empty() ? Json(nullptr) : Json(batch.options.shard)},
          {"requests", batch.rows.size()},
          {"status", count_statuses(batch.rows).to_json()},
          {"planned", batch.planned},
          {"finished_earlier", batch.earlier},
          {"units", table_units(columns_of(batch.rows))},
          {"rows", batch.rows}};
}

std::string for_people(const Batch& batch, const std::string& files) {
  const std::string text = fmt::format("{} request{}, {} planned now, {} finished earlier\n", batch.rows.size(),
                                       batch.rows.size() == 1 ? "" : "s", batch.planned, batch.earlier);
  return text + count_statuses(batch.rows).for_people() + fmt::format("  {:<14} {}\n", "files", files);
}

int tell(const Batch& batch, const std::optional<Shard>& shard) {
  const std::string part = shard ? fmt::format(".{}-of-{}", shard->index, shard->count) : "";
  const fs::path csv = fs::path(batch.options.out) / fmt::format("summary{}.csv", part);
  const fs::path json = fs::path(batch.options.out) / fmt::format("summary{}.json", part);
  const Json summary = summary_json(batch);
  write_file(csv, table_csv(batch.rows));
  write_file(json, json_text(summary));
  fmt::print("{}", batch.options.json ? json_text(summary) : for_people(batch, csv.string() + ", " + json.string()));
  return count_statuses(batch.rows).exit_code();
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
  CLI::Option* requests = command
                              ->add_option("requests", options->requests,
                                           "Request files, grids of requests (config/batch/reach_grid.yaml), folders "
                                           "with either; one that is called like a command below: ./status")
                              ->type_name("REQUESTS");
  CLI::Option* out =
      command
          ->add_option("--out", options->out,
                       "Folder of the results: one folder for each request, summary.csv and summary.json. A request is "
                       "finished when its folder has the result of the same request, robot, settings and "
                       "version of fjr, whatever the other options were; a deadline or a cancellation is no result")
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
  add_report_option(*command, options->settings);
  add_settings_option(*command, options->settings);
  add_talk(*command, options->talk);
  add_packed_batches(*command, exit_code);
  command->callback([command, requests, out, options, &exit_code] {
    if (!command->get_subcommands().empty()) return;
    for (const CLI::Option* needed : {requests, out}) {
      if (needed->empty()) throw CLI::RequiredError(needed->get_name());
    }
    exit_code = run(*options);
  });
}

}  // namespace fjr
