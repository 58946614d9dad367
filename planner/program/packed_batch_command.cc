#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/say.h"
#include "planner/batch/chunk.h"
#include "planner/batch/earlier.h"
#include "planner/batch/gather.h"
#include "planner/batch/items.h"
#include "planner/batch/manifest.h"
#include "planner/program/doubts.h"
#include "planner/program/ending.h"
#include "planner/program/packed_batch.h"
#include "planner/program/plan_pool.h"
#include "planner/program/plan_settings.h"
#include "planner/program/progress_line.h"
#include "planner/program/scratch.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Sizes of chunks. A chunk should take minutes: the overhead of a cluster's jobs outweighs smaller ones, and more work
// is lost with larger ones. Large batches have larger chunks, because an array of Slurm ends at 1000 unless configured
// otherwise.
constexpr std::size_t kChunkSize = 250, kMaxChunks = 1000;
constexpr std::chrono::seconds kBetweenTries{1};  // while another process has the chunk

struct PackedArguments {
  std::vector<std::string> requests, names;
  std::vector<std::size_t> chunks;
  std::string out, folder;
  std::size_t chunk_size = 0;
  std::size_t jobs = std::max(1U, std::thread::hardware_concurrency());
  bool json = false, unfinished = false;
  Talk talk = Talk::kUsual;
  PlanSettings settings;
};

// ---- prepare ----

int prepare(const PackedArguments& options) {
  const std::vector<BatchItem> items = collect_items(options.requests, options.out);
  check_default_robot(items);
  const std::size_t smallest = (items.size() + kMaxChunks - 1) / kMaxChunks;
  const std::size_t size = options.chunk_size > 0 ? options.chunk_size : std::max(kChunkSize, smallest);
  const Prepared prepared = fjr::prepare(options.out, items, to_arguments(options.settings), size);
  const Manifest manifest(options.out);
  fmt::print("{} request{} in {} chunk{}: {} new, {} changed, {} as before, {} not named this time\n",
             items.size() + prepared.kept, items.size() + prepared.kept == 1 ? "" : "s", manifest.chunks(),
             manifest.chunks() == 1 ? "" : "s", prepared.added, prepared.changed, prepared.unchanged, prepared.kept);
  return 0;
}

// ---- run ----

// Waits for the lock of a chunk. Returns nothing if interrupted.
std::optional<ChunkLock> wait_for(const Manifest& manifest, std::size_t chunk, ProgressLine& line) {
  for (;;) {
    if (auto lock = ChunkLock::take(manifest, chunk)) return lock;
    line.show("waiting for another process that plans it");
    if (ending_signalled(kBetweenTries)) return std::nullopt;
  }
}

class ChunkRun {
 public:
  ChunkRun(const Manifest& manifest, std::size_t chunk, const PackedArguments& options)
      : options_(options),
        words_(manifest.options()),
        want_proven_(manifest.asks_for("--proven")),
        want_uncertified_(manifest.asks_for("--keep-uncertified")),
        items_(manifest.items(chunk)),
        writer_(manifest, chunk) {}

  bool run(ProgressLine& line) {  // false: interrupted
    const std::vector<std::size_t> open = sort_out();
    const PlanPool pool{options_.jobs, [&](std::size_t index) { return begin(items_[index]); },
                        [&](std::size_t index, const PlanEnding& ending, bool interrupted) {
                          end(items_[index], ending, interrupted);
                        }};
    return !pool.plan(open, line).interrupted;
  }

  std::string for_people(std::size_t chunk) const {
    return fmt::format("chunk {}: {} request{}, {} planned now, {} finished earlier\n", chunk, items_.size(),
                       items_.size() == 1 ? "" : "s", planned_, earlier_);
  }

 private:
  bool is_finished(const ManifestItem& item, const Problem& problem) const {
    const auto files = [&](const std::string& file) { return writer_.file(item.item.name, file); };
    return finished_earlier(problem, files, want_uncertified_, want_proven_).has_value();
  }

  // Returns which items are left to be planned.
  std::vector<std::size_t> sort_out() {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const ManifestItem& item = items_[i];
      try {
        const Problem problem = load(item.item);
        tell_doubts(problem.robot);
        if (!is_finished(item, problem)) {
          open.push_back(i);
          continue;
        }
        writer_.confirm(item);
        ++earlier_;
      } catch (const InputError& error) {
        say("fjr: {}\n", error.what());
        writer_.refuse(item, bad_input_json(item.item.name, error.what(), error.field()));
      }
    }
    return open;
  }

  std::vector<std::string> begin(const ManifestItem& item) const {
    const std::string& name = item.item.name;
    write_file(scratch_.request(name), *item.item.yaml);
    std::vector<std::string> words = words_;
    words.insert(words.end(),
                 {"--jobs", "1", "--out", scratch_.results(name).string(), "--", scratch_.request(name).string()});
    return words;
  }

  // Stores the result of an item, unless it was cancelled; then it stays open.
  void end(const ManifestItem& item, const PlanEnding& ending, bool interrupted) {
    const Row row = row_at_end(item.item, ending, interrupted);
    if (row["status"] != name(PlanStatus::kCancelled)) {
      const fs::path results = scratch_.results(item.item.name);
      const bool answered = row["status"] != kFailedStatus;
      writer_.answer(item, row, answered ? std::optional(results) : std::nullopt);
      planned_ += answered ? 1 : 0;
    }
    scratch_.clear(item.item.name);
  }

  const PackedArguments& options_;
  std::vector<std::string> words_;
  bool want_proven_, want_uncertified_;
  std::vector<ManifestItem> items_;
  ChunkWriter writer_;
  Scratch scratch_;
  std::size_t planned_ = 0, earlier_ = 0;
};

bool run_chunk(const Manifest& manifest, std::size_t chunk, const PackedArguments& options) {
  ProgressLine line(fmt::format("chunk {}", chunk), options.talk);
  const auto lock = wait_for(manifest, chunk, line);
  if (!lock) return false;
  ChunkRun run(manifest, chunk, options);
  const bool completed = run.run(line);
  say_in(stdout, "{}", run.for_people(chunk));
  return completed;
}

std::vector<std::size_t> chunks_to_run(const Manifest& manifest, const std::vector<std::size_t>& given) {
  std::vector<std::size_t> chunks = given;
  if (given.empty()) {
    chunks.resize(manifest.chunks());
    std::iota(chunks.begin(), chunks.end(), std::size_t{1});
  }
  for (const std::size_t chunk : chunks) {
    if (chunk >= 1 && chunk <= manifest.chunks()) continue;
    throw InputError("command line", "", fmt::format("chunk {} is outside [1, {}]", chunk, manifest.chunks()));
  }
  return chunks;
}

std::string for_people(const BatchProgress& progress) {
  const std::size_t chunks = progress.unfinished.size();
  std::string text =
      fmt::format("{} request{} in {} chunk{}, {} planned in {} run{}\n{}", progress.requests,
                  progress.requests == 1 ? "" : "s", progress.chunks, progress.chunks == 1 ? "" : "s", progress.planned,
                  progress.runs, progress.runs == 1 ? "" : "s", progress.statuses.for_people());
  if (chunks > 0) {
    text += fmt::format("  {:<14} {} chunk{}: {}\n", "unfinished", chunks, chunks == 1 ? "" : "s",
                        in_ranges(progress.unfinished));
  }
  if (progress.under_way > 0) text += fmt::format("  {:<14} {}\n", "under way", progress.under_way);
  return text;
}

int gather_and_tell(const Manifest& manifest, bool json) {
  gather(manifest);
  const BatchProgress progress = look_at(manifest);
  if (json) {
    fmt::print("{}", json_text(to_json(progress)));
  } else {
    fmt::print("{}  {:<14} {}\n", for_people(progress), "files", manifest.results_file().string());
  }
  return progress.statuses.exit_code();
}

// Runs chunks. For some chunks the exit code tells whether every request has an answer, so that failed ones can be
// restarted.
int run(const PackedArguments& options) {
  const Manifest manifest(options.folder);
  const std::vector<std::size_t> chunks = chunks_to_run(manifest, options.chunks);
  catch_ending_signals();
  for (const std::size_t chunk : chunks) {
    if (!run_chunk(manifest, chunk, options)) return exit_code(PlanStatus::kCancelled);
  }
  if (options.chunks.empty()) return gather_and_tell(manifest, false);
  const std::vector<std::size_t> unfinished = look_at(manifest).unfinished;
  const bool complete = std::none_of(chunks.begin(), chunks.end(), [&](std::size_t chunk) {
    return std::find(unfinished.begin(), unfinished.end(), chunk) != unfinished.end();
  });
  return complete ? 0 : 1;
}

// ---- status, unpack ----

int tell_status(const PackedArguments& options) {
  const BatchProgress progress = look_at(Manifest(options.folder));
  fmt::print("{}", options.unfinished ? in_ranges(progress.unfinished) + "\n"
                   : options.json     ? json_text(to_json(progress))
                                      : for_people(progress));
  return 0;
}

int unpack_all(const PackedArguments& options) {
  const Manifest manifest(options.folder);
  for (const std::string& name : options.names) {
    unpack(manifest, name, options.names.size() == 1 ? fs::path(options.out) : fs::path(options.out) / name);
  }
  return 0;
}

// ---- command line ----

CLI::App* add_command(CLI::App& batch, const char* name, const char* about, PackedArguments& options) {
  CLI::App* command = batch.add_subcommand(name, about);
  command->add_option("folder", options.folder, "Folder of the batch, of fjr batch prepare --out")
      ->required()
      ->type_name("DIR");
  return command;
}

}  // namespace

void add_packed_batches(CLI::App& batch, int& exit_code) {
  const auto options = std::make_shared<PackedArguments>();
  const auto does = [&exit_code, options](CLI::App* command, int (*function)(const PackedArguments&)) {
    command->callback([options, function, &exit_code] { exit_code = function(*options); });
  };

  CLI::App* prepared = batch.add_subcommand(
      "prepare",
      "Divide requests into chunks, for many machines and few files: DIR/manifest.sqlite; again to add some");
  prepared->add_option("requests", options->requests, "Request files, grids of requests, folders with either")
      ->required()
      ->type_name("REQUESTS");
  prepared->add_option("--out", options->out, "Folder of the batch, which all machines have to see")
      ->required()
      ->type_name("DIR");
  prepared
      ->add_option("--chunk-size", options->chunk_size,
                   fmt::format("Requests in a chunk, which should take minutes; default: {}, or more where there would "
                               "be more than {} chunks",
                               kChunkSize, kMaxChunks))
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  add_options(*prepared, options->settings);
  does(prepared, prepare);

  CLI::App* ran =
      add_command(batch, "run",
                  "Plan what is not finished in some chunks; in all of them one after the other, and gather, "
                  "where none is named",
                  *options);
  ran->add_option("chunks", options->chunks, "Numbers of chunks, from 1; exit code 0 when all of them are finished")
      ->type_name("I");
  ran->add_option("--jobs", options->jobs, "Requests planned at a time; default: the number of cores")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  add_talk(*ran, options->talk);
  does(ran, run);

  CLI::App* gathered = add_command(batch, "gather", "Write DIR/results.sqlite, the table of what there is", *options);
  gathered->add_flag("--json", options->json, "Only JSON on stdout");
  does(gathered, [](const PackedArguments& o) { return gather_and_tell(Manifest(o.folder), o.json); });

  CLI::App* told = add_command(batch, "status", "How far a prepared batch is", *options);
  told->add_flag("--json", options->json, "Only JSON on stdout");
  told->add_flag("--unfinished", options->unfinished, "Only the numbers of the unfinished chunks, as 1-3,7");
  does(told, tell_status);

  CLI::App* unpacked = add_command(batch, "unpack", "Write the folders of single plans, as fjr plan would", *options);
  unpacked->add_option("names", options->names, "Names of requests")->required()->type_name("NAME");
  unpacked->add_option("--out", options->out, "Folder of the result; with several names one folder each in it")
      ->required()
      ->type_name("DIR");
  does(unpacked, unpack_all);
}

}  // namespace fjr
