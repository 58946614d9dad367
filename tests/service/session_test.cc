// A day of service, executor and clients in short, also with sanitizers: every process ends by itself with code 0,
// which it would not with a leak.
#include <gmock/gmock.h>

#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using testing::HasSubstr;

class SessionTest : public ServiceProcesses {};

TEST_F(SessionTest, LeavesNothingBehind) {
  write("slow.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: efficient\n");
  const auto service = serve();
  const auto executor = fjr({"executor", "--start", "0.3,0.2", "--state", path("state")}, "executor.log");
  ASSERT_TRUE(comes_true([&] { return executor->output().find("executing for") != std::string::npos; }, 30));
  const auto logged = [&](const std::string& text) {
    return comes_true([&] { return service->output().find(text) != std::string::npos; }, 30);
  };
  const auto ask = [&](const std::string& request, const std::string& log) {
    return fjr({"request", path(request), "--find", "20", "--silence", "30"}, log);
  };

  const auto executed =
      fjr({"request", path("quick.yaml"), "--execute", "--out", path("out"), "--find", "20"}, "a.log");
  EXPECT_EQ(executed->wait(), 0) << executed->output();
  EXPECT_THAT(executed->output(), HasSubstr("execution   code 0"));
  const auto refused = ask("bad.yaml", "b.log");
  EXPECT_EQ(refused->wait(), 2) << refused->output();

  const auto cancelled = ask("slow.yaml", "c.log");
  ASSERT_TRUE(logged("name=slow.yaml"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  cancelled->send(SIGINT);
  EXPECT_EQ(cancelled->wait(), 5) << cancelled->output();

  const auto lost = ask("slow.yaml", "d.log");
  for (int i = 0; i < 2; ++i) {  // it is tried once more
    ASSERT_TRUE(comes_true([&] { return !service->children().empty(); }));
    std::this_thread::sleep_for(std::chrono::milliseconds(800));
    for (const pid_t worker : service->children()) ::kill(worker, SIGKILL);
  }
  EXPECT_NE(lost->wait(), 0);
  EXPECT_THAT(lost->output(), HasSubstr("two solving processes ended unexpectedly"));

  const auto unfinished = ask("slow.yaml", "e.log");
  std::this_thread::sleep_for(std::chrono::milliseconds(1000));
  service->send(SIGTERM);
  EXPECT_EQ(service->wait(), 0) << service->output();
  EXPECT_NE(unfinished->wait(), 0);
  executor->send(SIGTERM);
  EXPECT_EQ(executor->wait(), 0) << executor->output();
}

}  // namespace
}  // namespace fjr
