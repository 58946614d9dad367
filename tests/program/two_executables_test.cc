// `fjr` as two executables: the one that users call, which plans, and the complete one, which takes its place for all
// other commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/cli.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class TwoExecutables : public Cli {
 protected:
  void TearDown() override {
    for (const char* name : {"LD_LIBRARY_PATH", "LD_TRACE_LOADED_OBJECTS"}) unsetenv(name);
    Cli::TearDown();
  }
};

// Loading these takes longer than starting the program without them.
TEST_F(TwoExecutables, PlanningLoadsNothingOfExportsIdentificationAndDds) {
  setenv("LD_TRACE_LOADED_OBJECTS", "1", 1);  // the loader lists what it loads, and ends
  const std::string loaded = run({"plan"}).out;
  EXPECT_THAT(loaded, HasSubstr("libipopt"));
  for (const char* library : {"libddsc", "libhdf5", "libmatio", "libcholmod", "libglog", "libcurl", "httplib"}) {
    EXPECT_THAT(loaded, Not(HasSubstr(library)));
  }
}

TEST_F(TwoExecutables, TheOtherCommandsAreHandedOver) {
  EXPECT_THAT(run({"--help"}).out, HasSubstr("executor"));
  EXPECT_THAT(run({"simulate", "--help"}).out, HasSubstr("--control"));
  const Result misspelt = run({"paln"});
  EXPECT_EQ(misspelt.exit_code, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("did you mean plan?"));
}

// As after the first half of the set-up.
TEST_F(TwoExecutables, WithoutTheCompleteOneTheOthersSayWhereItShouldBe) {
  const fs::path library = fs::path(FJR_EXECUTABLE).parent_path() / "lib/fjr/libfjr_folder.so";
  fs::copy_file(library, path("libfjr_folder.so"));
  setenv("LD_LIBRARY_PATH", path("").c_str(), 1);
  const Result result = run({"simulate", "a.csv", "--out", "b.csv"});
  EXPECT_EQ(result.exit_code, 1);
  const std::string missing =
      "the other commands are in " + path("fjr").string() + ", which cannot be started (No such file or directory)\n";
  EXPECT_EQ(result.err, "fjr: " + missing);
  const Result help = run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("verify"), Not(HasSubstr("simulate")), HasSubstr(missing)));
  EXPECT_EQ(run({}).exit_code, 2);
  EXPECT_EQ(run({"--version"}).exit_code, 0);
  EXPECT_EQ(run({"plan", "a.yaml", "--out", "b"}).exit_code, 2);  // for a.yaml is not there
}

}  // namespace
}  // namespace fjr
