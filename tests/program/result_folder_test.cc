// Results replace results: killed before every single system call, by a full disk, and beside what else is in the
// folder.
#include "planner/results/result_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>

#include "common/input_error.h"
#include "planner/results/export/formats.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;

void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

// The files of one plan, each of which says whose it is.
void write_results(const fs::path& folder, const std::string& plan, const std::string& status) {
  write(folder / "plan.json", R"({"status": ")" + status + R"(", "request_hash": ")" + plan + "\"}");
  if (status != "certified") return;
  for (const char* file : {"trajectory.csv", "solution.cbor", "trajectory.id"}) write(folder / file, plan);
}

bool replace(const fs::path& folder, const std::string& plan, const std::string& status) {
  NewResults results(folder);
  write_results(results.stage(), plan, status);
  return results.publish();
}

// Whose plan.json is in the folder, if the other files are that plan's too; otherwise what is wrong.
std::string owner_of(const fs::path& folder) {
  const std::string plan = contents(folder / "plan.json");
  const auto at = plan.find("request_hash\": \"");
  if (at == std::string::npos) return fs::is_empty(folder) ? "empty" : "no plan.json";
  const std::string owner = plan.substr(at + 16, plan.size() - at - 18);
  const bool certified = plan.find("certified") != std::string::npos;
  for (const char* file : {"trajectory.csv", "solution.cbor", "trajectory.id"}) {
    if (fs::exists(folder / file) != certified) return std::string("mixture: ") + file;
    if (certified && contents(folder / file) != owner) return std::string("mixture: ") + file;
  }
  if (fs::exists(folder / "report.html") || fs::exists(folder / "trajectory.uncertified.csv")) return "mixture";
  return owner;
}

class ResultFolder : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(out_); }
  void TearDown() override { fs::remove_all(place_); }

  // In memory, where it is there: what is written to a disk is waited for.
  const fs::path root_ = fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
  const fs::path place_ = root_ / ("fjr_result_folder_test_" + std::to_string(::getpid()));
  const fs::path out_ = place_ / "out";
};

TEST_F(ResultFolder, WhatIsReplacedByAFailureIsKept) {
  EXPECT_FALSE(replace(out_, "a", "certified"));
  EXPECT_EQ(value_of_results(out_), ResultValue::kPlan);
  EXPECT_TRUE(replace(out_, "b", "deadline"));
  EXPECT_EQ(owner_of(out_), "b");
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
  EXPECT_FALSE(replace(out_, "c", "infeasible"));  // b was worth nothing
  EXPECT_FALSE(replace(out_, "d", "cancelled"));   // c was, but less than a
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
  EXPECT_FALSE(replace(out_, "e", "certified"));
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
  EXPECT_FALSE(replace(out_, "e", "certified"));  // the same again
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
  EXPECT_TRUE(replace(out_, "f", "certified"));
  EXPECT_EQ(owner_of(out_ / kPrevious), "e");
  EXPECT_EQ(owner_of(out_), "f");
}

// A plan without its rows is of less use than an earlier one that has them.
TEST_F(ResultFolder, ADamagedPlanTakesNoOthersPlace) {
  EXPECT_FALSE(replace(out_, "a", "certified"));
  EXPECT_TRUE(replace(out_, "b", "certified"));
  write(out_ / "trajectory.csv", "");
  EXPECT_EQ(value_of_results(out_), ResultValue::kAnswer);
  EXPECT_FALSE(replace(out_, "c", "certified"));
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
  fs::remove(out_ / "trajectory.csv");
  EXPECT_FALSE(replace(out_, "d", "certified"));
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
}

// What is in the way is told before anything is moved.
TEST_F(ResultFolder, AFolderWithTheNameOfAFileStopsNothingHalfWay) {
  EXPECT_FALSE(replace(out_, "a", "certified"));
  fs::create_directory(out_ / "report.html");
  EXPECT_THROW(NewResults{out_}, InputError);
  fs::remove(out_ / "report.html");
  EXPECT_EQ(owner_of(out_), "a");
  fs::create_directories(out_ / kPrevious / "report.html");
  EXPECT_THROW(NewResults{out_}, InputError);
  fs::remove_all(out_ / kPrevious);
  EXPECT_EQ(owner_of(out_), "a");
  write(out_ / kPrevious, "a file");
  EXPECT_THROW(NewResults{out_}, InputError);
}

TEST_F(ResultFolder, APlanJsonOfSomebodyElseIsKept) {
  std::ofstream(out_ / "plan.json") << "p";
  EXPECT_TRUE(replace(out_, "a", "infeasible"));
  EXPECT_EQ(contents(out_ / kPrevious / "plan.json"), "p");
  EXPECT_FALSE(has_certified_plan(out_ / kPrevious));
  EXPECT_FALSE(replace(out_, "b", "cancelled"));
  EXPECT_EQ(contents(out_ / kPrevious / "plan.json"), "p");
}

TEST_F(ResultFolder, AnAnswerIsKeptFromAFailureWhereThereIsNothingBetter) {
  replace(out_, "a", "infeasible");
  EXPECT_TRUE(replace(out_, "b", "cancelled"));
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
}

TEST_F(ResultFolder, ResultsThatAreNotPublishedLeaveNoTrace) {
  replace(out_, "a", "certified");
  {
    NewResults results(out_);
    write_results(results.stage(), "b", "certified");
  }
  EXPECT_EQ(owner_of(out_), "a");
  EXPECT_EQ(std::distance(fs::directory_iterator(out_), fs::directory_iterator()), 4);
  EXPECT_EQ(std::distance(fs::directory_iterator(place_), fs::directory_iterator()), 1);
}

TEST_F(ResultFolder, AFolderThatWasRemovedMeanwhileIsMadeAgain) {
  fs::remove(out_);
  replace(out_, "a", "certified");
  EXPECT_EQ(owner_of(out_), "a");
  write(place_ / "file", "");
  EXPECT_THROW(NewResults(place_ / "file" / "out"), std::runtime_error);
}

TEST_F(ResultFolder, WhatElseIsInTheFolderStays) {
  write(out_ / "notes.txt", "mine");
  // An export of another plan would have a drive do what nobody asked for.
  for (const ExportFormat& format : export_formats()) write(out_ / fmt::format("export{}", format.suffix), "earlier");
  write(out_ / "report.html", "of an earlier plan");
  replace(out_, "a", "certified");
  for (const ExportFormat& format : export_formats()) {
    EXPECT_FALSE(fs::exists(out_ / fmt::format("export{}", format.suffix))) << format.name;
  }
  EXPECT_EQ(contents(out_ / "notes.txt"), "mine");
  fs::create_directories(out_ / "more");
  write(out_ / "more/notes.txt", "mine too");
  replace(out_, "b", "infeasible");
  fs::create_directories(out_ / kPrevious / "mine");
  replace(out_, "c", "certified");
  EXPECT_EQ(owner_of(out_), "c");
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
  EXPECT_EQ(contents(out_ / "notes.txt"), "mine");
  EXPECT_EQ(contents(out_ / "more/notes.txt"), "mine too");
  EXPECT_TRUE(fs::exists(out_ / kPrevious / "mine"));
}

TEST_F(ResultFolder, TheWorkingDirectoryAndALinkToAFolderWork) {
  const fs::path before = fs::current_path();
  fs::current_path(out_);
  replace(".", "a", "certified");
  fs::current_path(before);
  EXPECT_EQ(owner_of(out_), "a");
  fs::create_directory_symlink(out_, place_ / "link");
  replace(place_ / "link", "b", "deadline");
  EXPECT_EQ(owner_of(out_), "b");
  EXPECT_TRUE(fs::is_symlink(place_ / "link"));
  EXPECT_EQ(owner_of(out_ / kPrevious), "a");
}

// Runs `work` in a process that stops before every system call, and calls `look` whenever one may have changed a file:
// what is on the disk then is what a kill at that instant would leave.
void at_every_instant(const std::function<void()>& work, const std::function<void()>& look) {
  const pid_t child = fork();
  if (child == 0) {
    ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    raise(SIGSTOP);
    work();
    _exit(0);
  }
  const std::set<std::uint64_t> changes = {
      SYS_openat, SYS_write, SYS_writev,  SYS_rename, SYS_renameat, SYS_renameat2, SYS_unlink, SYS_unlinkat,  SYS_link,
      SYS_linkat, SYS_mkdir, SYS_mkdirat, SYS_rmdir,  SYS_chmod,    SYS_fchmod,    SYS_close,  SYS_exit_group};
  int status = 0;
  waitpid(child, &status, 0);
  ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD);  // without it a call does not tell its number
  for (; WIFSTOPPED(status); waitpid(child, &status, 0)) {
    __ptrace_syscall_info info = {};
    ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof info, &info);
    if (info.op == PTRACE_SYSCALL_INFO_ENTRY && changes.contains(info.entry.nr)) look();
    ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
  }
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

class Killed : public ResultFolder {
 protected:
  // `intact`: whole without anybody's help.
  void check(bool intact) {
    const fs::path copies = place_.string() + "_copy";
    const fs::path copy = copies / "out";
    int old = 0, fresh = 0;
    replace(out_, "old", "certified");
    at_every_instant([this] { replace(out_, "new", "infeasible"); },
                     [&] {
                       fs::remove_all(copies);
                       fs::copy(place_, copies, fs::copy_options::recursive);
                       if (!intact) FolderLock(copy.string());  // what every reader begins with
                       const std::string owner = owner_of(copy);
                       EXPECT_THAT(owner, AnyOf("old", "new"));
                       EXPECT_EQ(owner_of(owner == "old" ? copy : copy / kPrevious), "old");
                       EXPECT_TRUE(owner == "new" || fresh == 0) << "there and back";
                       owner == "old" ? ++old : ++fresh;
                       EXPECT_NO_THROW(replace(copy, "next", "certified"));  // nothing is in its way
                       EXPECT_EQ(owner_of(copy), "next");
                       EXPECT_EQ(owner_of(copy / kPrevious), "old");
                       EXPECT_EQ(std::distance(fs::directory_iterator(copies), fs::directory_iterator()), 1);
                     });
    fs::remove_all(copies);
    EXPECT_GT(old, 20);  // it was looked at before and after
    EXPECT_GT(fresh, 5);
  }
};

TEST_F(Killed, AtAnyInstantLeavesTheOldOrTheNewResultsWhole) { check(true); }

TEST_F(Killed, BesideForeignFilesToo) {
  write(out_ / "notes.txt", "mine");
  check(true);
  EXPECT_EQ(contents(out_ / "notes.txt"), "mine");
}

TEST_F(Killed, WhereFoldersCannotBeExchangedTheNextReaderCompletesIt) {
  fs::create_directories(out_ / "more");
  check(false);
}

// A disk of its own, a mount point; in a process that may mount.
TEST_F(ResultFolder, AFullDiskLeavesTheOldResults) {
  constexpr int kMayNot = 77;
  const pid_t child = fork();
  if (child == 0) {
    if (unshare(CLONE_NEWNS) != 0 || mount("", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) _exit(kMayNot);
    if (mount("tmpfs", out_.c_str(), "tmpfs", 0, "size=64k") != 0) _exit(kMayNot);
    replace(out_, "a", "certified");
    bool refused = false;
    try {
      NewResults results(out_);
      write_results(results.stage(), "b", "certified");
      write(results.stage() / "report.html", std::string(1 << 20, 'x'));
      results.publish();
    } catch (const std::exception&) {
      refused = true;
    }
    const bool kept = refused && owner_of(out_) == "a";
    replace(out_, "c", "certified");
    _exit(kept && owner_of(out_) == "c" && owner_of(out_ / kPrevious) == "a" ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == kMayNot) GTEST_SKIP() << "this user may not mount a file system";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(ResultFolder, TwoWritersTakeTurns) {
  replace(out_, "a", "certified");
  const pid_t child = fork();
  if (child == 0) {
    for (int i = 0; i < 50; ++i) replace(out_, "x", i % 2 == 0 ? "certified" : "infeasible");
    _exit(0);
  }
  for (int i = 0; i < 50; ++i) {
    {
      const FolderLock lock(out_);
      EXPECT_THAT(owner_of(out_), AnyOf("a", "x"));
    }
    replace(out_, "a", "certified");
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace fjr
