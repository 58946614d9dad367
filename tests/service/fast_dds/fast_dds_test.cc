// The service speaks DDS, not only Cyclone DDS.
#include <gmock/gmock.h>

#include "tests/support/service_processes.h"

namespace fjr {
namespace {

class FastDdsTest : public ServiceProcesses {
 protected:
  Process client(const std::string& refused, const std::string& garbage) const {
    return Process({FJR_FAST_DDS_CLIENT, std::to_string(domain_), refused, garbage}, path("client.log"));
  }
};

TEST_F(FastDdsTest, GetsAThousandReplies) {
  const auto service = serve();
  Process asking = client("1000", "0");
  EXPECT_EQ(asking.wait(), 0);
  EXPECT_THAT(asking.output(), testing::ContainsRegex("refused=1000 state=3 rows=[1-9][0-9]+ ends_there=1"));
}

// Samples by the right name whose bytes are not of the type: Fast DDS says nothing of types, so they do arrive.
TEST_F(FastDdsTest, CannotHarmTheServiceWithBytesThatAreNoRequest) {
  const auto service = serve();
  Process asking = client("10", "2000");
  EXPECT_EQ(asking.wait(), 0);
  EXPECT_THAT(asking.output(), testing::ContainsRegex("refused=10 state=3 rows=[1-9][0-9]+ ends_there=1"));
  // It says so once a second, and not 2000 times.
  EXPECT_TRUE(comes_true([&] { return service->output().find("DDS: ") != std::string::npos; }));
  EXPECT_LT(service->output().size(), 40000u);
}

}  // namespace
}  // namespace fjr
