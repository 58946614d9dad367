// Folders of processes that were killed are removed by the next one, and nothing else is.
#include "planner/program/scratch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

void write(const fs::path& file) { std::ofstream(file) << "something"; }

// What is thrown ends the child.
pid_t fork_for(const std::function<void()>& work) noexcept {
  const pid_t child = ::fork();
  if (child != 0) return child;
  work();
  ::_exit(0);
}

int status_of(pid_t child) {
  int status = -1;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return status;
}

class ScratchTest : public testing::Test {
 protected:
  ~ScratchTest() override { fs::remove_all(root_); }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(parent_)) all.push_back(entry.path().filename());
    return all;
  }
  std::string only_name() const {
    const std::vector<std::string> all = names();
    EXPECT_EQ(all.size(), 1U);
    return all.empty() ? "" : all.front();
  }
  // The folder of a process that ended without removing it, by a name of ours.
  void leave_one(const std::string& name) const {
    const std::vector<std::string> before = names();
    EXPECT_EQ(status_of(fork_for([] {
                const Scratch scratch;
                write(scratch.request("a"));
                fs::create_directory(scratch.results("a"));
                write(scratch.results("a") / "plan.json");
                ::_exit(0);  // without destructors
              })),
              0);
    for (const std::string& one : names()) {
      if (std::find(before.begin(), before.end(), one) == before.end()) fs::rename(parent_ / one, parent_ / name);
    }
  }

  const fs::path root_ = fs::temp_directory_path() / ("fjr_scratch_test_" + std::to_string(::getpid()));
  const fs::path parent_ = root_ / "tmp";
  const TemporaryFolder temporary_{parent_};
};

TEST_F(ScratchTest, GoesWithItsContentAndTakesRequestsOfAnyName) {
  {
    const Scratch scratch;
    for (const std::string name : {"a", "a.yaml", "requests", "results", "new"}) {
      write(scratch.request(name));
      ASSERT_TRUE(fs::create_directory(scratch.results(name)));
    }
    scratch.clear("a");
    EXPECT_FALSE(fs::exists(scratch.request("a")));
    EXPECT_FALSE(fs::exists(scratch.results("a")));
    EXPECT_TRUE(fs::exists(scratch.request("a.yaml")));
    EXPECT_TRUE(fs::exists(scratch.results("a.yaml")));
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(ScratchTest, TheNextRemovesWhatAKillLeavesAndNotWhatIsInUse) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = fork_for([&] {
    const Scratch scratch;
    write(scratch.request("a"));
    while (::write(ready[1], "r", 1) == 1) ::pause();
  });
  char letter = 0;
  ASSERT_EQ(::read(ready[0], &letter, 1), 1);
  const std::string name = only_name();
  { const Scratch beside; }
  EXPECT_THAT(names(), UnorderedElementsAre(name));
  EXPECT_TRUE(fs::exists(parent_ / name / "requests" / "a.yaml"));
  ::kill(child, SIGKILL);
  EXPECT_TRUE(WIFSIGNALED(status_of(child)));
  EXPECT_THAT(names(), UnorderedElementsAre(name));
  { const Scratch next; }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(ScratchTest, NothingElseIsRemoved) {
  leave_one("another-name");
  leave_one("fjr-batch-of-another-machine");
  const fs::path elsewhere = parent_ / "fjr-batch-of-another-machine";
  char host[256] = {};
  ASSERT_EQ(::gethostname(host, sizeof host - 1), 0);
  fs::rename(elsewhere / ("lock." + std::string(host)), elsewhere / "lock.another-machine");
  fs::create_directory(parent_ / "fjr-batch-of-an-older-version");
  write(parent_ / "fjr-batch-of-an-older-version" / "a.yaml");
  write(parent_ / "fjr-batch-file");
  fs::create_directory_symlink(parent_ / "another-name", parent_ / "fjr-batch-link");
  std::size_t kept = 5;
  leave_one("fjr-batch-of-another-user");
  if (::chown((parent_ / "fjr-batch-of-another-user").c_str(), 1, 1) == 0) ++kept;  // only root may do that
  leave_one("fjr-batch-left");
  { const Scratch next; }
  EXPECT_EQ(names().size(), kept) << testing::PrintToString(names());
  EXPECT_FALSE(fs::exists(parent_ / "fjr-batch-left"));
  EXPECT_TRUE(fs::exists(parent_ / "another-name" / "results" / "a" / "plan.json"));
  EXPECT_TRUE(fs::exists(elsewhere / "results" / "a" / "plan.json"));
}

// Each of them removes what the others leave, while the others make theirs.
TEST_F(ScratchTest, ProcessesThatStartAtTheSameTimeKeepTheirs) {
  std::vector<pid_t> children;
  for (int i = 0; i < 6; ++i) {
    children.push_back(fork_for([] {
      for (int k = 0; k < 100; ++k) {
        const Scratch scratch;
        write(scratch.request("a"));
        fs::create_directory(scratch.results("a"));
        if (!fs::exists(scratch.request("a")) || !fs::exists(scratch.results("a"))) ::_exit(1);
        if (k == 99) ::_exit(0);  // without destructors
      }
    }));
  }
  for (const pid_t child : children) EXPECT_EQ(status_of(child), 0);
  { const Scratch last; }
  EXPECT_THAT(names(), IsEmpty());
}

}  // namespace
}  // namespace fjr
