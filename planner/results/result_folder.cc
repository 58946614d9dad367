#include "planner/results/result_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

#include "common/bounded_json.h"
#include "common/input_error.h"
#include "common/read_file.h"
#include "planner/plan.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStage = ".fjr-next";       // being written; useless if left behind by an interruption
constexpr const char* kPending = ".fjr-pending";  // complete; must be moved into the folder file by file
constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::milliseconds kPause{5};

std::runtime_error failure(const char* what, const fs::path& path, int error) {
  return std::runtime_error(
      fmt::format("cannot {} {}: {}", what, path.string(), std::generic_category().message(error)));
}

// Returns the path of the folder without symbolic links.
fs::path resolved(const fs::path& folder) {
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  return error ? fs::path() : real;
}

// Returns the folder, and creates it again if it was removed since the planning began, so that the results are not
// lost.
fs::path created_if_removed(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  const fs::path real = resolved(folder);
  if (real.empty()) throw failure("write to", folder, error ? error.value() : ENOENT);
  return real;
}

// Returns the temporary name beside a folder under which it is exchanged.
fs::path beside(const fs::path& folder) {
  return folder.parent_path() / fmt::format(".{}{}", folder.filename().string(), kStage);
}

Descriptor open_folder(const fs::path& folder) {
  return Descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

// Flushes a file or folder to the disk, if the file system supports it.
void sync(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.number() < 0 || (::fsync(file.number()) != 0 && errno != EINVAL && errno != ENOTSUP)) {
    throw failure("write", path, errno);
  }
}

void sync_all(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    entry.is_directory() ? sync_all(entry.path()) : sync(entry.path());
  }
  sync(folder);
}

void move(const fs::path& from, const fs::path& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) throw failure("write", to, errno);
}

void link_or_copy(const fs::path& from, const fs::path& to) {
  if (::link(from.c_str(), to.c_str()) == 0) return;
  std::error_code error;
  fs::copy_file(from, to, error);
  if (error) throw failure("write", to, error.value());
}

bool has_folders_in_it(const fs::path& folder) {
  std::error_code error;
  const fs::directory_iterator entries(folder, error);
  return std::any_of(begin(entries), end(entries), [](const fs::directory_entry& entry) {
    const fs::path name = entry.path().filename();
    return entry.symlink_status().type() == fs::file_type::directory && name != kPrevious && name != kStage;
  });
}

// ---- recovery after an interruption ----

// Moves the results file by file. An empty file means that the new results do not have this file. Files that were moved
// before an interruption no longer exist in `from`.
void move_results(const fs::path& from, const fs::path& to) {
  for (const char* name : kResultFiles) {
    const fs::path file = from / name;
    if (!fs::exists(file)) continue;
    if (fs::file_size(file) > 0) {
      move(file, to / name);
    } else {
      fs::remove(to / name);
      fs::remove(file);
    }
  }
}

// Completes a replacement. plan.json is moved last, so it is missing until all other files are in place.
void complete_moves(const fs::path& folder) {
  const fs::path pending = folder / kPending;
  if (!fs::exists(pending)) return;
  check_names_in(folder);  // somebody may have put folders there since the interruption
  if (fs::exists(pending / "plan.json")) fs::remove(folder / "plan.json");
  if (fs::exists(pending / kPrevious)) {
    fs::create_directory(folder / kPrevious);
    move_results(pending / kPrevious, folder / kPrevious);
  }
  move_results(pending, folder);
  sync(folder);
  fs::remove_all(pending);
}

// Marks the files that the new results do not have by empty files.
void mark_missing(const fs::path& folder) {
  for (const char* name : kResultFiles) {
    const fs::path mark = folder / name;
    if (!fs::exists(mark) && !std::ofstream(mark)) throw failure("write", mark, errno);
  }
  sync(folder);
}

// Cleans up after an exchange: removes the old results, and moves files that were added to the old folder meanwhile to
// the new one.
void clear_beside(const fs::path& folder) {
  const fs::path old = beside(folder);
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(old, error)) {
    const fs::path name = entry.path().filename();
    const bool stays = is_result(name) || name == kPrevious || name == kStage || fs::exists(folder / name, error);
    if (stays) {
      fs::remove_all(entry.path(), error);
    } else {
      fs::rename(entry.path(), folder / name, error);
    }
  }
  fs::remove(old, error);
}

nlohmann::json read_plan_json(const fs::path& folder) {
  const std::optional<std::string> text = read_file(folder / "plan.json");
  return text ? json_from_text<nlohmann::json>(*text) : nlohmann::json();
}

std::string text_at(const nlohmann::json& plan, const char* key) {
  const auto found = plan.is_object() ? plan.find(key) : plan.end();
  return found != plan.end() && found->is_string() ? found->get<std::string>() : "";
}

bool same_results(const fs::path& a, const fs::path& b) {
  const nlohmann::json first = read_plan_json(a), second = read_plan_json(b);
  for (const char* key : {"status", "request_hash", "robot_hash"}) {
    if (text_at(first, key) != text_at(second, key)) return false;
  }
  for (const char* file : {"trajectory.csv", "trajectory.uncertified.csv"}) {
    if (read_file(a / file) != read_file(b / file)) return false;
  }
  return true;
}

}  // namespace

bool is_result(const fs::path& name) {
  return std::any_of(kResultFiles.begin(), kResultFiles.end(), [&](const char* file) { return name == file; });
}

void check_names_in(const fs::path& folder) {
  std::error_code ignored;
  const fs::path previous = folder / kPrevious;
  for (const fs::path& place : {folder, previous}) {
    for (const char* name : kResultFiles) {
      if (!fs::is_directory(place / name, ignored)) continue;
      throw InputError((place / name).string(), "", "is a folder where a file of the plan is written: move it away");
    }
  }
  if (!fs::exists(fs::symlink_status(previous, ignored)) || fs::is_directory(previous, ignored)) return;
  throw InputError(previous.string(), "", "is a file where earlier plans are kept: move it away");
}

bool has_certified_plan(const fs::path& folder) {
  return plan_status(text_at(read_plan_json(folder), "status")) == PlanStatus::kCertified;
}

ResultValue value_of_results(const fs::path& folder) {
  const std::string said = text_at(read_plan_json(folder), "status");
  const std::optional<PlanStatus> status = plan_status(said);
  std::error_code none;
  if (fs::file_size(folder / "trajectory.csv", none) > 0 && !none) return ResultValue::kPlan;
  if (said.empty() && fs::exists(folder / "plan.json")) return ResultValue::kPlan;
  const bool answered = status == PlanStatus::kCertified || status == PlanStatus::kInfeasible ||
                        status == PlanStatus::kNotConverged || status == PlanStatus::kUncertified;
  return answered ? ResultValue::kAnswer : ResultValue::kNothing;
}

// The lock is on the parent, because the folder itself is exchanged.
FolderLock::FolderLock(const fs::path& folder) {
  const fs::path real = resolved(folder);
  if (real.empty()) return;
  parent_ = open_folder(real.parent_path());
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (parent_.number() >= 0 && ::flock(parent_.number(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) break;
    if (std::chrono::steady_clock::now() > end) {
      throw std::runtime_error(fmt::format("{} is in use by another process for a minute now", folder.string()));
    }
    std::this_thread::sleep_for(kPause);
  }
  complete_moves(real);
}

NewResults::NewResults(const fs::path& folder)
    : folder_(created_if_removed(folder)), lock_(folder), stage_(folder_ / kStage) {
  clear_beside(folder_);
  check_names_in(folder);
  std::error_code error;
  fs::remove_all(stage_, error);
  if (!fs::create_directory(stage_, error)) throw failure("write to", folder, error.value());
}

NewResults::~NewResults() {
  std::error_code error;
  fs::remove_all(stage_, error);
}

bool NewResults::publish() {
  const bool kept = keep_previous();
  sync_all(stage_);
  if (!may_be_exchanged() || !exchange()) move_one_by_one();
  return kept;
}

// Links or copies the replaced results, or those kept in `previous` before, into `previous` of the new folder. Returns
// whether they are the replaced ones.
bool NewResults::keep_previous() const {
  const ResultValue replaced = value_of_results(folder_), before = value_of_results(folder_ / kPrevious);
  const bool lost = replaced == ResultValue::kPlan ||
                    (replaced == ResultValue::kAnswer && value_of_results(stage_) < ResultValue::kPlan);
  const bool keep = lost && replaced >= before && !same_results(folder_, stage_);
  const fs::path from = keep ? folder_ : folder_ / kPrevious;
  if (!keep && !fs::exists(from)) return false;
  fs::create_directory(stage_ / kPrevious);
  for (const char* file : kResultFiles) {
    if (fs::exists(from / file)) link_or_copy(from / file, stage_ / kPrevious / file);
  }
  return keep;
}

// Returns whether the folders can be exchanged: the new one must equal the old one in everything except the results.
bool NewResults::may_be_exchanged() const {
  struct stat old = {}, fresh = {};
  if (::stat(folder_.c_str(), &old) != 0 || ::stat(stage_.c_str(), &fresh) != 0) return false;
  if (old.st_uid != fresh.st_uid || old.st_gid != fresh.st_gid) return false;
  std::error_code error;
  const fs::path here = fs::current_path(error);
  const bool within = std::mismatch(folder_.begin(), folder_.end(), here.begin(), here.end()).first == folder_.end();
  return !within && !has_folders_in_it(folder_) && !has_folders_in_it(folder_ / kPrevious) &&
         ::chmod(stage_.c_str(), old.st_mode & 07777) == 0;
}

// Returns false if the system does not support it; then nothing has changed.
bool NewResults::exchange() const {
  const auto carry = [](const fs::path& from, const fs::path& to) {
    for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
      const fs::path name = entry.path().filename();
      if (is_result(name) || name == kPrevious || name == kStage) continue;
      if (::link(entry.path().c_str(), (to / name).c_str()) != 0) return false;
    }
    return true;
  };
  if (!carry(folder_, stage_)) return false;
  if (fs::exists(folder_ / kPrevious) && fs::exists(stage_ / kPrevious) &&
      !carry(folder_ / kPrevious, stage_ / kPrevious)) {
    return false;
  }
  const fs::path fresh = beside(folder_);
  if (std::rename(stage_.c_str(), fresh.c_str()) != 0) return false;
  if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, folder_.c_str(), RENAME_EXCHANGE) != 0) {
    move(fresh, stage_);
    return false;
  }
  sync(folder_.parent_path());
  clear_beside(folder_);
  return true;
}

void NewResults::move_one_by_one() const {
  if (fs::exists(stage_ / kPrevious)) mark_missing(stage_ / kPrevious);
  mark_missing(stage_);
  move(stage_, folder_ / kPending);
  sync(folder_);
  complete_moves(folder_);
}

}  // namespace fjr
