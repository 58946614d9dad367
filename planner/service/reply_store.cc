#include "planner/service/reply_store.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <utility>

#include "common/input_error.h"
#include "common/sha256.h"
#include "planner/service/reply_record.h"

namespace fjr {
namespace {

constexpr std::chrono::seconds kPatience{2};  // that an answer waits for a disk that hangs
constexpr std::chrono::seconds kTryAgain{1};  // after a disk has taken nothing
constexpr int kRecordFormat = 1;              // PRAGMA user_version of the file

// With WAL and synchronous FULL, a commit is on the disk when it returns, after one fsync, and a transaction
// interrupted by a crash is discarded. The log file is truncated again after a large commit.
constexpr const char* kDurably =
    "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA journal_size_limit = 8388608;";
constexpr const char* kReplies = R"(
  CREATE TABLE IF NOT EXISTS replies (
    number INTEGER PRIMARY KEY, id TEXT UNIQUE, robot_id TEXT, sha256 TEXT, reply BLOB);
)";

std::int64_t record_format(const Database& database) {
  Statement format = database.query("PRAGMA user_version");
  return format.step() ? format.integer(0) : 0;
}

// Throws if the file is of another version; it is then left unchanged.
void prepare_tables(const Database& database, const std::filesystem::path& file) {
  Transaction transaction(database);
  if (!database.query("SELECT 1 FROM sqlite_master").step()) {
    database.execute(kReplies);
    database.execute(fmt::format("PRAGMA user_version = {}", kRecordFormat));
  } else if (const std::int64_t format = record_format(database); format != kRecordFormat) {
    throw std::runtime_error(fmt::format("{} holds replies of format {}, this version of fjr writes {}", file.string(),
                                         format, kRecordFormat));
  }
  transaction.commit();
}

}  // namespace

ReplyStore::ReplyStore(std::filesystem::path folder, std::string robot_id, std::function<void()> wake)
    : folder_(std::move(folder)),
      file_(folder_ / "replies.sqlite"),
      robot_id_(std::move(robot_id)),
      wake_(std::move(wake)) {
  load();
  writer_ = std::jthread([this](const std::stop_token& over) { keep_writing(over); });
}

ReplyStore::~ReplyStore() = default;

void ReplyStore::load() {
  try {
    open();
    read_earlier();
    spdlog::info("remembers {} earlier replies in {}", earlier_.size(), file_.string());
  } catch (const InputError& damaged) {
    set_aside(damaged.problem());
  } catch (const std::exception& error) {
    failing_ = true;
    tell(error.what());
  }
}

void ReplyStore::open() {
  std::filesystem::create_directories(folder_);
  database_.reset();
  database_.emplace(file_, Database::Access::kWrite);
  database_->execute(kDurably);
  prepare_tables(*database_, file_);
}

// Reads the stored replies. A damaged record is skipped without affecting the others.
void ReplyStore::read_earlier() {
  Statement rows = database_->query("SELECT id, sha256, reply FROM replies WHERE robot_id = ? ORDER BY number",
                                    std::string_view(robot_id_));
  while (rows.step()) {
    const std::string id = rows.text(0), record = rows.text(2);
    try {
      if (sha256_hex(record) != rows.text(1)) throw std::runtime_error("its checksum is not that of its bytes");
      earlier_.push_back(std::make_shared<const Reply>(from_record(record)));
    } catch (const std::exception& error) {
      spdlog::warn("a damaged reply is left out: {} in {}: {}", id, file_.string(), error.what());
      if (const auto named = request_id_from(id)) changes_.push_back({*named, nullptr});
    }
  }
}

// Handles a damaged file: renames it, and writes the records that could be read to a new one.
void ReplyStore::set_aside(const std::string& why) {
  database_.reset();
  const std::filesystem::path damaged = file_.string() + ".damaged";
  std::error_code ignored;
  std::filesystem::rename(file_, damaged, ignored);
  for (const char* part : {"-wal", "-shm"}) {  // the newest replies may be in these
    std::filesystem::rename(file_.string() + part, damaged.string() + part, ignored);
  }
  spdlog::error("{} is damaged ({}) and set aside as {}: {} replies could be read of it", file_.string(), why,
                damaged.filename().string(), earlier_.size());
  changes_.clear();
  for (const SharedReply& reply : earlier_) changes_.push_back({reply->id, reply});
}

void ReplyStore::write(const std::vector<Change>& changes) {
  if (!database_) open();
  Transaction transaction(*database_);
  for (const auto& [id, reply] : changes) {
    const std::string name = to_text(id);
    if (!reply) {
      database_->run("DELETE FROM replies WHERE id = ?", std::string_view(name));
      continue;
    }
    const std::string record = to_record(*reply), checksum = sha256_hex(record);
    database_->run("INSERT OR IGNORE INTO replies (id, robot_id, sha256, reply) VALUES (?, ?, ?, ?)",
                   std::string_view(name), std::string_view(robot_id_), std::string_view(checksum), Blob{record});
  }
  transaction.commit();
}

// Writes the changes to the disk. Returns an error message, or an empty string on success.
std::string ReplyStore::try_to_write(const std::vector<Change>& changes) {
  try {
    write(changes);
    return "";
  } catch (const std::exception& error) {
    database_.reset();  // opened again next time: it may be another disk by then
    return error.what();
  }
}

void ReplyStore::add(SharedReply reply) {
  {
    const std::lock_guard lock(mutex_);
    if (failing_) settled_.push_back(reply->id);
    changes_.push_back({reply->id, std::move(reply)});
  }
  changed_.notify_one();
}

void ReplyStore::forget(const RequestId& id) {
  {
    const std::lock_guard lock(mutex_);
    const auto is_it = [&](const Change& change) { return change.id == id; };
    const auto deletes = [&](const Change& change) { return is_it(change) && !change.reply; };
    const bool is_deleted = std::any_of(changes_.begin(), changes_.end(), deletes);
    const bool was_waiting = std::erase_if(changes_, is_it) > 0;
    const bool is_written = std::any_of(writing_.begin(), writing_.end(), is_it);
    // A reply that was only waiting has left nothing on the disk, unless an earlier one of that id was to be deleted.
    if (was_waiting && !is_deleted && !is_written) return;
    changes_.push_back({id, nullptr});
  }
  changed_.notify_one();
}

std::vector<RequestId> ReplyStore::take_settled() {
  std::vector<RequestId> settled;
  bool hangs = false;
  {
    const std::lock_guard lock(mutex_);
    hangs = !failing_ && busy_since_ && Clock::now() - *busy_since_ > kPatience;
    if (hangs) {
      failing_ = true;
      for (const std::vector<Change>* waiting : {&writing_, &changes_}) note_settled(*waiting);
    }
    settled = std::exchange(settled_, {});
  }
  if (hangs) tell(fmt::format("{} has taken nothing for {} s", file_.string(), kPatience.count()));
  return settled;
}

void ReplyStore::tell(const std::string& problem) const {
  spdlog::error("replies are not remembered over a restart while this lasts: {}", problem);
}

void ReplyStore::note_settled(const std::vector<Change>& changes) {
  for (const Change& change : changes) {
    if (change.reply) settled_.push_back(change.id);
  }
}

void ReplyStore::keep_writing(const std::stop_token& over) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (failing_) {
      changed_.wait_for(lock, over, kTryAgain, [] { return false; });
    } else {
      changed_.wait(lock, over, [this] { return !changes_.empty(); });
    }
    if (over.stop_requested() && (failing_ || changes_.empty())) return;
    writing_ = std::exchange(changes_, {});
    busy_since_ = Clock::now();
    lock.unlock();
    const std::string problem = try_to_write(writing_);
    lock.lock();
    busy_since_.reset();
    note_settled(writing_);
    const bool failed_before = std::exchange(failing_, !problem.empty());
    failing_ ? put_back() : writing_.clear();
    lock.unlock();
    if (!problem.empty() && !failed_before) tell(problem);
    if (problem.empty() && failed_before) spdlog::info("replies are remembered again in {}", file_.string());
    wake_();
    lock.lock();
  }
}

// Puts changes that could not be written back in their order, to try again, except for replies dropped meanwhile.
void ReplyStore::put_back() {
  for (const Change& later : changes_) {
    std::erase_if(writing_, [&](const Change& change) { return change.id == later.id && change.reply; });
  }
  writing_.insert(writing_.end(), std::make_move_iterator(changes_.begin()), std::make_move_iterator(changes_.end()));
  changes_ = std::exchange(writing_, {});
}

}  // namespace fjr
