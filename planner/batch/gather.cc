#include "planner/batch/gather.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "planner/batch/chunk.h"
#include "planner/batch/table.h"
#include "planner/results/result_folder.h"
#include "planner/store/database.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Called with the name of a request of a chunk, and with its answer if there is one.
using TakeAnswer = std::function<void(const std::string& name, const ChunkAnswer* answer)>;

void for_each(const Manifest& manifest, std::size_t chunk, bool rows, const TakeAnswer& take) {
  std::unordered_map<std::string, ChunkAnswer> answers;
  if (const auto reader = ChunkReader::open(manifest, chunk)) {
    reader->for_each([&](const ChunkAnswer& answer) { answers.emplace(answer.name, answer); }, rows);
  }
  manifest.for_each(chunk, [&](const std::string& name, const std::string& digest) {
    const auto found = answers.find(name);
    const bool current = found != answers.end() && found->second.digest == digest;
    take(name, current ? &found->second : nullptr);
  });
}

Row row_of(const Manifest& manifest, const std::string& name, const ChunkAnswer* answer) {
  if (answer != nullptr) return Row::parse(answer->row);
  std::size_t chunk = 0;
  return make_row(manifest.item(name, chunk), kOpenStatus, "not planned yet");
}

void bind(Statement& statement, int index, const Json& value) {
  if (value.is_null()) return statement.bind(index, nullptr);
  if (value.is_string()) return statement.bind(index, std::string_view(value.get_ref<const std::string&>()));
  if (value.is_number_float()) return statement.bind(index, value.get<double>());
  const bool too_large =
      value.is_number_unsigned() && value.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max();
  if (value.is_number_integer() && !too_large) return statement.bind(index, value.get<std::int64_t>());
  statement.bind(index, std::string_view(value.dump()));
}

std::string quoted_column(const std::string& column) {
  std::string text = "\"";
  for (const char c : column) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

void write_units(const Database& database, const Columns& columns) {
  database.execute("CREATE TABLE units (\"column\" TEXT PRIMARY KEY, unit TEXT)");
  const Json units = table_units(columns);
  for (const auto& [column, unit] : units.items()) {
    database.run("INSERT INTO units VALUES (?, ?)", column, unit.get<std::string>());
  }
}

void create_results(const Database& database, const Columns& columns) {
  std::string names;
  for (const std::string& column : columns.names()) {
    names += quoted_column(column) + (column == "name" ? " TEXT PRIMARY KEY, " : ", ");
  }
  database.execute(fmt::format("CREATE TABLE results ({}chunk INTEGER)", names));
}

// Rows stand in the table in the order of their row ids, which are the places of their names.
void insert_results(const Database& database, const Manifest& manifest, const Columns& columns) {
  std::unordered_map<std::string, std::size_t> places;
  for (std::string& name : manifest.names()) {
    const std::size_t place = places.size() + 1;
    places.emplace(std::move(name), place);
  }
  std::string names = "rowid", marks = "?";
  for (const std::string& column : columns.names()) names += ", " + quoted_column(column), marks += ", ?";
  Statement insert = database.prepare(fmt::format("INSERT INTO results ({}, chunk) VALUES ({}, ?)", names, marks));
  for (std::size_t chunk = 1; chunk <= manifest.chunks(); ++chunk) {
    for_each(manifest, chunk, true, [&](const std::string& name, const ChunkAnswer* answer) {
      const auto place = places.find(name);
      if (place == places.end()) return;  // added just now: it is gathered the next time
      int index = 0;
      insert.bind(++index, place->second);
      for (const Json& value : columns.values(row_of(manifest, name, answer))) bind(insert, ++index, value);
      insert.bind(++index, chunk);
      insert.step();
      insert.reset();
    });
  }
}

}  // namespace

BatchProgress look_at(const Manifest& manifest) {
  BatchProgress progress;
  progress.chunks = manifest.chunks();
  for (std::size_t chunk = 1; chunk <= progress.chunks; ++chunk) {
    bool finished = true;
    for_each(manifest, chunk, false, [&](const std::string&, const ChunkAnswer* answer) {
      const std::string status = answer == nullptr ? kOpenStatus : answer->status;
      ++progress.requests;
      progress.statuses.add(status);
      finished = finished && status != kOpenStatus && status != kFailedStatus;
    });
    if (!finished) progress.unfinished.push_back(chunk);
    if (ChunkLock::is_held(manifest, chunk)) ++progress.under_way;
    if (const auto reader = ChunkReader::open(manifest, chunk)) {
      const ChunkRuns runs = reader->runs();
      progress.runs += runs.runs;
      progress.planned += runs.planned;
    }
  }
  return progress;
}

Json to_json(const BatchProgress& progress) {
  return {{"version", FJR_VERSION},    {"requests", progress.requests},   {"status", progress.statuses.to_json()},
          {"chunks", progress.chunks}, {"under_way", progress.under_way}, {"unfinished", progress.unfinished},
          {"runs", progress.runs},     {"planned", progress.planned}};
}

std::string in_ranges(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    if (!text.empty()) text += ",";
    text += last == i ? std::to_string(numbers[i]) : fmt::format("{}-{}", numbers[i], numbers[last]);
    i = last + 1;
  }
  return text;
}

void gather(const Manifest& manifest) {
  Columns columns;  // found in a first pass, so that 1e5 rows need not be kept in memory
  for (std::size_t chunk = 1; chunk <= manifest.chunks(); ++chunk) {
    for_each(manifest, chunk, true,
             [&](const std::string& name, const ChunkAnswer* answer) { columns.add(row_of(manifest, name, answer)); });
  }
  const fs::path file = manifest.results_file();
  const fs::path fresh = temporary_beside(file);
  try {
    const Database database(fresh, Database::Access::kWrite);
    database.execute("PRAGMA journal_mode = OFF");  // an incomplete file is deleted anyway
    Transaction transaction(database);
    create_results(database, columns);
    insert_results(database, manifest, columns);
    write_units(database, columns);
    transaction.commit();
    fs::rename(fresh, file);
  } catch (...) {
    std::error_code error;
    fs::remove(fresh, error);
    throw;
  }
}

void unpack(const Manifest& manifest, const std::string& name, const fs::path& folder) {
  std::size_t chunk = 0;
  const BatchItem item = manifest.item(name, chunk);
  const auto reader = ChunkReader::open(manifest, chunk);
  if (!reader || !reader->has(name, false)) {
    throw InputError(manifest.folder().string(), "", fmt::format("has no answer to {} yet", shown(name)));
  }
  for (const bool previous : {false, true}) {
    if (!reader->has(name, previous)) continue;
    const fs::path place = previous ? folder / kPrevious : folder;
    fs::create_directories(place);
    NewResults results(place);
    reader->unpack(name, previous, results.stage());
    results.publish();
  }
  write_file(folder / (name + ".yaml"), *item.yaml);
}

}  // namespace fjr
