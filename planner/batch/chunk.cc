#include "planner/batch/chunk.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <exception>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "common/atomic_file.h"
#include "common/host_name.h"
#include "common/read_file.h"
#include "common/strict_yaml.h"
#include "planner/batch/deflate.h"
#include "planner/results/plan_json.h"
#include "planner/results/result_folder.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// previous: 0 for the current answer, 1 for the certified plan before it.
constexpr const char* kChunkTables = R"(
  CREATE TABLE IF NOT EXISTS plans (
    name TEXT, previous INTEGER, status TEXT, digest TEXT, run INTEGER, row TEXT, PRIMARY KEY (name, previous));
  CREATE TABLE IF NOT EXISTS files (
    name TEXT, previous INTEGER, file TEXT, size INTEGER, deflated BLOB, PRIMARY KEY (name, previous, file));
  CREATE TABLE IF NOT EXISTS runs (
    run INTEGER PRIMARY KEY, host TEXT, process INTEGER, began TEXT, ended TEXT, planned INTEGER);
)";

constexpr const char* kPlanJson = "plan.json";

// ---- locks ----

struct flock byte_of(std::size_t chunk) {
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(chunk);
  lock.l_len = 1;
  return lock;
}

fs::path locks_file(const Manifest& manifest) { return manifest.folder() / "chunks" / "locks"; }

Descriptor open_locks(const Manifest& manifest) {
  const fs::path file = locks_file(manifest);
  Descriptor locks(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (locks.number() < 0) throw std::system_error(errno, std::generic_category(), "cannot open " + file.string());
  return locks;
}

// ---- who plans ----

std::string now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

Database open_for_writing(const fs::path& file) {
  Database database(file, Database::Access::kWrite);
  Transaction transaction(database);
  database.execute(kChunkTables);
  transaction.commit();
  return database;
}

std::int64_t begin_run(const Database& database) {
  database.run("INSERT INTO runs (host, process, began, planned) VALUES (?, ?, ?, 0)", host_name(), ::getpid(), now());
  Statement last = database.query("SELECT max(run) FROM runs");
  last.step();
  return last.integer(0);
}

// ---- answers ----

// Returns the content of a file of the current answer; nothing if there is no such file or it is damaged.
std::optional<std::string> current_file(const Database& database, const std::string& name, const std::string& file) {
  Statement packed =
      database.query("SELECT size, deflated FROM files WHERE name = ? AND previous = 0 AND file = ?", name, file);
  if (!packed.step()) return std::nullopt;
  try {
    return inflated(packed.text(1), static_cast<std::size_t>(packed.integer(0)));
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

// Makes room for a new answer. A certified plan that can no longer be unpacked does not replace `previous`.
void move_aside(const Database& database, const std::string& name) {
  Statement current = database.query("SELECT status FROM plans WHERE name = ? AND previous = 0", name);
  if (!current.step()) return;
  const bool certified = current.text(0) == fjr::name(PlanStatus::kCertified) &&
                         current_file(database, name, kPlanJson) && current_file(database, name, "trajectory.csv");
  for (const char* table : {"plans", "files"}) {
    database.run(fmt::format("DELETE FROM {} WHERE name = ? AND previous = ?", table), name, certified ? 1 : 0);
    if (certified) database.run(fmt::format("UPDATE {} SET previous = 1 WHERE name = ?", table), name);
  }
}

void pack(const Database& database, const std::string& name, const std::string& file, const std::string& bytes) {
  database.run("INSERT INTO files VALUES (?, 0, ?, ?, ?)", name, file, bytes.size(), Blob{deflated(bytes)});
}

void pack_folder(const Database& database, const std::string& name, const fs::path& folder) {
  for (const char* file : kResultFiles) {
    if (const auto bytes = read_file(folder / file)) pack(database, name, file, *bytes);
  }
}

}  // namespace

std::optional<ChunkLock> ChunkLock::take(const Manifest& manifest, std::size_t chunk) {
  Descriptor locks = open_locks(manifest);
  struct flock lock = byte_of(chunk);
  if (::fcntl(locks.number(), F_OFD_SETLK, &lock) == 0) return ChunkLock(std::move(locks));
  if (errno == EAGAIN || errno == EACCES) return std::nullopt;
  throw std::system_error(errno, std::generic_category(), "cannot lock a byte of chunks/locks");
}

bool ChunkLock::is_held(const Manifest& manifest, std::size_t chunk) {
  // Only reads, because the batch may be somebody else's.
  const Descriptor locks(::open(locks_file(manifest).c_str(), O_RDONLY | O_CLOEXEC));
  if (locks.number() < 0) {
    if (errno == ENOENT) return false;  // nobody has locked anything yet
    throw std::system_error(errno, std::generic_category(), "cannot open " + locks_file(manifest).string());
  }
  struct flock lock = byte_of(chunk);
  return ::fcntl(locks.number(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

ChunkWriter::ChunkWriter(const Manifest& manifest, std::size_t chunk)
    : database_(open_for_writing(manifest.chunk_file(chunk))), run_(begin_run(database_)) {}

ChunkWriter::~ChunkWriter() {
  try {
    database_.run("UPDATE runs SET ended = ? WHERE run = ?", now(), run_);
  } catch (const std::exception&) {  // a full disk has been reported by the call that stored answers
  }
}

std::optional<std::string> ChunkWriter::file(const std::string& name, const std::string& file) const {
  return current_file(database_, name, file);
}

void ChunkWriter::confirm(const ManifestItem& item) const {
  database_.run("UPDATE plans SET digest = ? WHERE name = ? AND previous = 0 AND digest != ?", item.digest,
                item.item.name, item.digest);
}

void ChunkWriter::put(const ManifestItem& item, const Row& row) const {
  move_aside(database_, item.item.name);
  database_.run("INSERT INTO plans VALUES (?, 0, ?, ?, ?, ?)", item.item.name, row["status"].get<std::string>(),
                item.digest, run_, row.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void ChunkWriter::answer(const ManifestItem& item, const Row& row, const std::optional<fs::path>& folder) const {
  Transaction transaction(database_);
  put(item, row);
  if (folder) {
    pack_folder(database_, item.item.name, *folder);
    database_.run("UPDATE runs SET planned = planned + 1 WHERE run = ?", run_);
  }
  transaction.commit();
}

void ChunkWriter::refuse(const ManifestItem& item, const Json& plan) const {
  Transaction transaction(database_);
  put(item, make_row(item.item, plan));
  pack(database_, item.item.name, kPlanJson, json_text(plan));
  transaction.commit();
}

std::optional<ChunkReader> ChunkReader::open(const Manifest& manifest, std::size_t chunk) {
  const fs::path file = manifest.chunk_file(chunk);
  if (!fs::exists(file)) return std::nullopt;
  ChunkReader reader(file);
  // It may have been made, and nothing be in it yet.
  if (!reader.database_.query("SELECT 1 FROM sqlite_master WHERE name = 'runs'").step()) return std::nullopt;
  return reader;
}

void ChunkReader::for_each(const std::function<void(const ChunkAnswer&)>& take, bool rows) const {
  Statement answers = database_.query(
      fmt::format("SELECT name, digest, status, {} FROM plans WHERE previous = 0", rows ? "row" : "''"));
  while (answers.step()) take({answers.text(0), answers.text(1), answers.text(2), answers.text(3)});
}

ChunkRuns ChunkReader::runs() const {
  Statement sums = database_.query("SELECT count(*), ifnull(sum(planned), 0) FROM runs");
  sums.step();
  return {static_cast<std::size_t>(sums.integer(0)), static_cast<std::size_t>(sums.integer(1))};
}

bool ChunkReader::has(const std::string& name, bool previous) const {
  return database_.query("SELECT 1 FROM files WHERE name = ? AND previous = ?", name, previous ? 1 : 0).step();
}

void ChunkReader::unpack(const std::string& name, bool previous, const fs::path& folder) const {
  Statement files =
      database_.query("SELECT file, size, deflated FROM files WHERE name = ? AND previous = ?", name, previous ? 1 : 0);
  while (files.step()) {
    const std::string file = files.text(0);
    if (!is_result(file)) throw std::runtime_error(fmt::format("{}: {} is no file of a plan", name, shown(file)));
    write_file(folder / file, inflated(files.text(2), static_cast<std::size_t>(files.integer(1))));
  }
}

}  // namespace fjr
