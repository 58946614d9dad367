// The types of version 0.1 are served on: what was compiled with them meets today's programs.
#include <gmock/gmock.h>

#include "tests/support/service_processes.h"

namespace fjr {
namespace {

class OlderTypesTest : public ServiceProcesses {
 protected:
  std::unique_ptr<Process> with_dds(const std::string& program, const std::string& log) const {
    return std::make_unique<Process>(
        std::vector<std::string>{"/usr/bin/env", "CYCLONEDDS_URI=file://" FJR_SOURCE_DIR "/config/cyclonedds.xml",
                                 program, std::to_string(domain_)},
        path(log));
  }
};

// What changed only in the names of nested types is the same type on the wire, to DDS's check of types too.
TEST_F(OlderTypesTest, AreTodaysOnEveryTopicInBothDirections) {
  const auto older = with_dds(FJR_EVERY_OLDER_TYPE, "older.log");
  const auto today = with_dds(FJR_EVERY_TYPE, "today.log");
  const auto has_everything = [](const Process& process) { return process.output() == "everything\n"; };
  EXPECT_TRUE(
      comes_true([&] { return has_everything(*older) && has_everything(*today); }, 15))  // they give up after 10
      << "older: " << older->output() << "today: " << today->output();
}

TEST_F(OlderTypesTest, AreServed) {
  const auto service = serve();
  const auto executor = fjr({"executor", "--state", path("state")}, "executor.log");
  ASSERT_TRUE(comes_true([&] { return executor->output().find("executing for") != std::string::npos; }));
  const auto client = with_dds(FJR_OLDER_CLIENT, "client.log");
  EXPECT_EQ(client->wait(), 0);
  EXPECT_EQ(client->output(),
            "planned: 3\nalong a path: 3\nprogress: 1\ncancelled while it was solved\ncancelled: 6\ncertified: 1\n"
            "executed: 0\nis there: 1\ncounted: 1\nheld: 1\n");
}

}  // namespace
}  // namespace fjr
