// Programs that use fjr's topic names for types of their own cost nobody anything.
#include <gmock/gmock.h>

#include "tests/support/service_processes.h"

namespace fjr {
namespace {

class OtherTypesTest : public ServiceProcesses {};

TEST_F(OtherTypesTest, DoNotDisturbTheService) {
  const auto service = serve();
  const std::string configuration = "CYCLONEDDS_URI=file://" FJR_SOURCE_DIR "/config/cyclonedds.xml";
  std::vector<std::unique_ptr<Process>> strangers;
  for (const std::string type : {"fjr::msg::PlanRequest", "another::Type"}) {
    strangers.push_back(std::make_unique<Process>(
        std::vector<std::string>{"/usr/bin/env", configuration, FJR_STRANGER, std::to_string(domain_), type},
        path("stranger" + std::to_string(strangers.size()) + ".log")));
  }
  const auto during = fjr({"request", path("quick.yaml")}, "during.log");
  EXPECT_EQ(during->wait(), 0) << during->output();
  for (const auto& stranger : strangers) EXPECT_EQ(stranger->wait(), 0) << stranger->output();
  const auto after = fjr({"request", path("bad.yaml")}, "after.log");
  EXPECT_EQ(after->wait(), 2) << after->output();
  const auto status = fjr({"status", "--json"}, "status.log");
  EXPECT_EQ(status->wait(), 0);
  EXPECT_THAT(status->output(), testing::HasSubstr("\"received\": 2,"));  // nothing of the strangers'
}

}  // namespace
}  // namespace fjr
