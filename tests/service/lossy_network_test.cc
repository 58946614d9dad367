// A network that loses one packet in twenty: everything is answered, and every motion is executed once.
#include <gmock/gmock.h>
#include <sched.h>

#include <atomic>

#include "planner/client/client.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using testing::HasSubstr;

// The loopback interface of a network namespace of this process and its children.
bool lose_packets(const std::filesystem::path& log) {
  if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  Process script({"/bin/sh", "-ec",
                  "ip link set lo up; nft add table inet lossy;"
                  "nft add chain inet lossy input '{ type filter hook input priority 0; }';"
                  "nft add rule inet lossy input meta l4proto udp numgen random mod 1000 '<' 50 counter drop"},
                 log);
  return script.wait() == 0;
}

class LossyNetworkTest : public ServiceProcesses {
 protected:
  void SetUp() override {
    ServiceProcesses::SetUp();
    if (!lose_packets(path("nft.log"))) GTEST_SKIP() << "no network of our own here: " << contents(path("nft.log"));
  }
  void TearDown() override {
    if (!IsSkipped()) {
      Process list({"/bin/sh", "-c", "nft list table inet lossy"}, path("dropped.log"));
      EXPECT_EQ(list.wait(), 0);
      EXPECT_THAT(list.output(), testing::ContainsRegex("counter packets [1-9][0-9]+ "));  // it did lose some
    }
    ServiceProcesses::TearDown();
  }

  // The final reply to a request from a client of its own.
  Reply ask(const std::string& yaml) const {
    Order order;
    order.id = new_client();
    order.name = "request.yaml";
    order.document = yaml;
    ClientOptions options;
    options.network.domain = domain_;
    options.find = 20;
    return request_plan(order, options).reply;
  }
};

TEST_F(LossyNetworkTest, AnswersEveryRequest) {
  const auto service = serve();
  constexpr int kClients = 6, kRequests = 10;
  std::atomic<int> refused = 0, solved = 0;
  {
    std::vector<std::jthread> clients;
    for (int client = 0; client < kClients; ++client) {
      clients.emplace_back([&, client] {
        for (int i = 0; i < kRequests; ++i) {
          if (ask(kBadRequest).why.field == "goal.q[1]") ++refused;
        }
        if (client < 2 && ask(kQuickRequest).state == ReplyState::kSolved) ++solved;
      });
    }
  }
  EXPECT_EQ(refused, kClients * kRequests);
  EXPECT_EQ(solved, 2);
}

TEST_F(LossyNetworkTest, ExecutesEveryMotionOnce) {
  write("back.yaml", "start: {q: [0.42, 0.08]}\ngoal: {q: [0.3, 0.2]}\nobjective: fastest\n");
  const auto service = serve();
  const auto executor = fjr({"executor", "--start", "0.3,0.2", "--state", path("state")}, "executor.log");
  ASSERT_TRUE(comes_true([&] { return executor->output().find("executing for") != std::string::npos; }));
  for (int motion = 0; motion < 3; ++motion) {
    const std::string file = motion % 2 == 0 ? "quick.yaml" : "back.yaml";
    const auto request = fjr({"request", path(file), "--execute", "--find", "20"}, "request.log");
    EXPECT_EQ(request->wait(), 0) << request->output();
    EXPECT_THAT(request->output(), HasSubstr("execution   code 0"));
  }
  const std::string log = executor->output();
  int executed = 0;
  for (std::size_t at = 0; (at = log.find("finished id=", at)) != std::string::npos; ++at) ++executed;
  EXPECT_EQ(executed, 3) << log;
}

}  // namespace
}  // namespace fjr
