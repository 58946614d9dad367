// What bash completes, from what fjr itself prints for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/cli.h"

namespace fjr {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

class Completion : public Cli {
 protected:
  // What is offered for the last of the words.
  std::vector<std::string> offered(const std::string& words) {
    write("completion.bash", run({"completion", "bash"}).out);
    write("ask.bash",
          "source completion.bash\nCOMP_WORDS=(" + words +
              ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_fjr\nprintf '%s\\n' \"${COMPREPLY[@]}\" > offered\n");
    EXPECT_EQ(std::system(("cd '" + path("").string() + "' && bash ask.bash").c_str()), 0);
    std::istringstream lines(contents(path("offered")));
    std::vector<std::string> all;
    for (std::string line; std::getline(lines, line);) {
      if (!line.empty()) all.push_back(line);
    }
    return all;
  }
};

TEST_F(Completion, OffersCommandsThatHelpLists) {
  EXPECT_THAT(offered("fjr ''"), AllOf(Contains("plan"), Contains("completion"), Not(Contains("worker"))));
  EXPECT_THAT(offered("fjr ve"), ElementsAre("verify"));
  EXPECT_THAT(offered("fjr robot ''"), ElementsAre("new", "check"));
}

TEST_F(Completion, OffersOptionsOfTheCommand) {
  EXPECT_THAT(offered("fjr plan request.yaml --warm-"), IsEmpty());
  EXPECT_THAT(offered("fjr plan request.yaml --wa"), ElementsAre("--warm"));
  EXPECT_THAT(offered("fjr batch prepare --chunk"), ElementsAre("--chunk-size"));
  EXPECT_THAT(offered("fjr batch --chunk"), IsEmpty());
}

TEST_F(Completion, OffersValuesWhereTheyAreListed) {
  EXPECT_THAT(offered("fjr plan --linear-solver m"), Contains("mumps"));
  EXPECT_THAT(offered("fjr experiment mo"), ElementsAre("motor_friction", "motor_inertia"));
}

TEST_F(Completion, LeavesFilesToTheShell) {
  EXPECT_THAT(offered("fjr plan ''"), IsEmpty());
  EXPECT_THAT(offered("fjr batch --out ''"), IsEmpty());
}

TEST_F(Completion, OtherShellsAreRefused) {
  const Result result = run({"completion", "fish"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
}

}  // namespace
}  // namespace fjr
