// A folder with the results of one plan. Whatever ends the program, and whenever, its files are of one plan: the old
// one or the new one.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>

#include "common/descriptor.h"

namespace fjr {

// The files that make up the results of a plan. Whatever else is in the folder stays as it is. plan.json is the last
// that is put in its place where files are moved one by one.
inline constexpr std::array<const char*, 7> kResultFiles = {
    "trajectory.csv", "trajectory.uncertified.csv", "solution.cbor", "report.html", "compared.html", "trajectory.id",
    "plan.json"};
inline constexpr const char* kPrevious = "previous";  // the folder within it for results that were replaced

// What results are worth keeping for.
enum class Worth {
  kNothing,  // there are none, or the request was refused, cancelled or out of time
  kAnswer,   // planned to the end, without a certified trajectory
  kPlan      // certified
};

// By the status in plan.json. A trajectory.csv without one is kept like a certified plan, and so is a plan.json without
// a status, which is somebody else's.
Worth worth_of(const std::filesystem::path& folder);

bool has_certified_plan(const std::filesystem::path& folder);  // by the status in plan.json

// While it lives no other fjr replaces the results in the folder. A replacement that was interrupted is completed
// first, so that what is read then belongs together. Nothing happens for a folder that does not exist, and nothing is
// locked where the file system has no locks. Throws std::runtime_error when another process holds it for a minute.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  Descriptor parent_;
};

// Results on their way into a folder.
class NewResults {
 public:
  // Makes the folder where it does not exist. Throws std::runtime_error where that cannot be done.
  explicit NewResults(const std::filesystem::path& folder);
  ~NewResults();  // what was not published is removed
  NewResults(const NewResults&) = delete;
  NewResults& operator=(const NewResults&) = delete;

  // Where the files of the new results are to be written.
  const std::filesystem::path& stage() const { return stage_; }

  // Puts them in place of the old ones, all at once: the two folders are exchanged. Where that is not possible (another
  // file system or owner, a folder with further folders in it, the working directory) a mark that survives any
  // interruption is set first, and whoever reads or writes the folder next completes what is not complete. Certified
  // results that are replaced by others, and any answer that is replaced by less, are in `previous` afterwards, unless
  // what is there already is worth more. Returns whether the replaced results were moved there.
  // The files are on the disk when it returns. Throws std::runtime_error; then the old results are still there.
  bool publish();

 private:
  bool keep_previous() const;
  bool may_be_exchanged() const;
  bool exchange() const;
  void move_one_by_one() const;

  std::filesystem::path folder_;  // without symbolic links
  FolderLock lock_;
  std::filesystem::path stage_;
};

}  // namespace fjr
