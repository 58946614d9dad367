// The wall clock is stepped by an hour, back or forth, under service, executor and clients: nothing changes for them.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "planner/dds/reader.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/wire_reply.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using Clock = std::chrono::steady_clock;
using testing::HasSubstr;

constexpr std::int64_t kHour = 3600;

// How regularly service and executor speak: in this process no clock is stepped.
class Listener {
 public:
  explicit Listener(unsigned domain)
      : participant_(domain),
        states_(participant_, participant_.handle()),
        statuses_(participant_, participant_.handle()) {}

  struct Silence {
    double executor = 0, service = 0;  // [s] longest
  };

  Silence listen(double seconds) {
    const auto began = Clock::now();
    auto of_executor = began, of_service = began;
    Silence longest;
    const auto since = [](Clock::time_point then) {
      return std::chrono::duration<double>(Clock::now() - then).count();
    };
    while (since(began) < seconds) {
      if (take(states_)) of_executor = Clock::now();
      if (take(statuses_)) of_service = Clock::now();
      longest.executor = std::max(longest.executor, since(of_executor));
      longest.service = std::max(longest.service, since(of_service));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return longest;
  }

  bool wait_for(ExecutorMode mode, double time) {
    return comes_true(
        [&] {
          (void)take(states_);
          return !state_.robot_id.empty() && state_.mode == mode && state_.time >= time;
        },
        20);
  }

 private:
  template <class T>
  bool take(dds::Reader<T>& reader) {
    bool any = false;
    reader.take_all([&](const T& message, const dds_sample_info_t& info) {
      if (!info.valid_data) return;
      any = true;
      if constexpr (std::is_same_v<T, fjr_msg_ExecutorState>) state_ = dds::decode(message);
    });
    return any;
  }

  dds::Participant participant_;
  dds::Reader<fjr_msg_ExecutorState> states_;
  dds::Reader<fjr_msg_PlannerStatus> statuses_;
  ExecutorState state_;
};

class ClockTest : public ServiceProcesses, public testing::WithParamInterface<std::int64_t> {
 protected:
  void SetUp() override {
    ServiceProcesses::SetUp();
    step(0);
    write("there.yaml", "goal: {q: [0.9, -0.3]}\nduration: 2.5\n");
    write("back.yaml", "goal: {q: [0.3, 0.2]}\nobjective: fastest\n");
    write("on.yaml", "goal: {q: [0.42, 0.08]}\nobjective: fastest\n");
  }

  // All processes of fjr: the wall clock is so many seconds off from now on.
  void step(std::int64_t seconds) const {
    const std::int64_t nanoseconds = seconds * 1'000'000'000;
    const int file = ::open(path("clock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    ASSERT_EQ(::pwrite(file, &nanoseconds, sizeof nanoseconds, 0), static_cast<ssize_t>(sizeof nanoseconds));
    ::close(file);
  }

  std::vector<std::string> clock() const {
    return {"LD_PRELOAD=" FJR_STEPPED_CLOCK, "FJR_CLOCK_STEP=" + path("clock").string()};
  }
  std::unique_ptr<Process> request(const std::string& name) const {
    return fjr({"request", path(name), "--execute", "--find", "10"}, name + ".log", clock());
  }
};
INSTANTIATE_TEST_SUITE_P(Steps, ClockTest, testing::Values(-kHour, kHour));

TEST_P(ClockTest, AStepChangesNothing) {
  const auto service = serve({}, clock());
  const auto executor = fjr({"executor", "--start", "0.3,0.2", "--state", path("state")}, "executor.log", clock());
  Listener listener(domain_);
  ASSERT_TRUE(listener.wait_for(ExecutorMode::kResting, 0));

  // Idle. Heartbeats come every 150 ms, states every millisecond; a lease is 0.5 s.
  step(GetParam());
  const Listener::Silence idle = listener.listen(2);
  EXPECT_LT(idle.executor, 0.5);
  EXPECT_LT(idle.service, 0.5);
  EXPECT_THAT(service->output(), Not(HasSubstr("absent for")));

  // While it is planned, and in mid-motion, in which it can be held.
  const auto there = request("there.yaml");
  ASSERT_TRUE(comes_true([&] { return service->output().find("accepted") != std::string::npos; }));
  step(0);
  ASSERT_TRUE(listener.wait_for(ExecutorMode::kExecuting, 0.5)) << there->output();
  step(GetParam());
  const Listener::Silence moving = listener.listen(0.5);
  EXPECT_LT(moving.executor, 0.3);
  EXPECT_LT(moving.service, 0.5);
  const auto asked = Clock::now();
  const auto hold = fjr({"hold"}, "hold.log", clock());
  EXPECT_EQ(hold->wait(), 0) << hold->output();
  EXPECT_LT(Clock::now() - asked, std::chrono::seconds(4));
  EXPECT_EQ(there->wait(), 1);
  EXPECT_THAT(there->output(), HasSubstr("hold was commanded at"));

  // What comes later is taken, also after one more step.
  const auto back = request("back.yaml");
  EXPECT_EQ(back->wait(), 0) << back->output();
  step(0);
  const auto again = request("on.yaml");
  EXPECT_EQ(again->wait(), 0) << again->output();

  const auto ended = Clock::now();
  service->send(SIGTERM);
  executor->send(SIGTERM);
  EXPECT_EQ(service->wait(), 0);
  EXPECT_EQ(executor->wait(), 0);
  EXPECT_LT(Clock::now() - ended, std::chrono::seconds(4));
}

}  // namespace
}  // namespace fjr
