// A folder with the results of one plan. Even if the program is interrupted at any time, all its files belong to the
// same plan, either the old or the new one.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>

#include "common/descriptor.h"

namespace fjr {

// The files that make up the results of a plan. Other files in the folder stay as they are. If files are moved one by
// one, plan.json is moved last.
inline constexpr std::array<const char*, 11> kResultFiles = {"trajectory.csv",   "trajectory.uncertified.csv",
                                                             "solution.cbor",    "report.html",
                                                             "compared.html",    "export.csv",
                                                             "export.mat",       "export.mcap",
                                                             "export.ros2.mcap", "trajectory.id",
                                                             "plan.json"};
// Returns whether a file of this name is one of them.
bool is_result(const std::filesystem::path& name);
inline constexpr const char* kPrevious = "previous";  // the folder within it for results that were replaced

// How valuable results are, by which NewResults::publish() decides whether to keep replaced ones.
enum class ResultValue {
  kNothing,  // there are none, or the request was refused, cancelled or out of time
  kAnswer,   // planned to the end, without a certified trajectory
  kPlan      // certified
};

// Decides by the status in plan.json. A folder with rows in trajectory.csv, whatever the status, or with a plan.json
// without a status (which is not from fjr) counts as one with a certified plan; one that has lost its rows as an
// answer.
ResultValue value_of_results(const std::filesystem::path& folder);

// Throws InputError if something in the folder keeps results from being written there: a folder with the name of one of
// their files, or a file with that of the folder for results that were replaced.
void check_names_in(const std::filesystem::path& folder);

bool has_certified_plan(const std::filesystem::path& folder);  // by the status in plan.json

// While it exists, no other fjr process replaces the results in the folder. An interrupted replacement is completed
// first, so that the files belong together. Nothing happens if the folder does not exist, and nothing is locked if the
// file system has no locks. Throws std::runtime_error if another process holds the lock for a minute.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  Descriptor parent_;
};

// New results that are written to a temporary folder and then published.
class NewResults {
 public:
  // Creates the folder if necessary. Throws std::runtime_error if that fails, and InputError as check_names_in().
  explicit NewResults(const std::filesystem::path& folder);
  ~NewResults();  // removes results that were not published
  NewResults(const NewResults&) = delete;
  NewResults& operator=(const NewResults&) = delete;

  // Returns the folder to which the files of the new results must be written.
  const std::filesystem::path& stage() const { return stage_; }

  // Replaces the old results atomically by exchanging the two folders. If that is not possible (another file system or
  // owner, subfolders, the working directory), a persistent mark is set first, and after an interruption the next
  // process that reads or writes the folder completes the replacement. Certified results that are replaced, and an
  // answer that is replaced by anything but a plan, are in `previous` afterwards, unless more valuable ones are there
  // already or the new results are the same. Returns whether they were put there. The files are on the disk when it
  // returns. Throws std::runtime_error on failure; the old results are then unchanged.
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
