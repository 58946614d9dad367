// fjr hold and fjr stop against executors that answer, do not answer, or answer only in part: played by this process.
#include <gmock/gmock.h>
#include <sched.h>

#include <cstdlib>
#include <optional>

#include "planner/dds/reader.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/writer.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

// Takes commands, and reports the states that it is told to.
class PlayedExecutor {
 public:
  explicit PlayedExecutor(const dds::Participant& participant, const std::string& partition = "")
      : publisher_(participant.publisher(partition)),
        commands_(participant, participant.handle()),
        states_(participant, publisher_.handle()) {}

  // What it reports from now on, and once it has been commanded; nothing: it is silent.
  std::optional<ExecutorMode> mode, commanded_mode;
  int commands = 0;
  Clock::time_point first;

  void play() {
    commands_.take_all([this](const fjr_msg_ExecutorCommand&, const dds_sample_info_t& info) {
      if (!info.valid_data) return;
      if (commands++ == 0) first = Clock::now();
      if (commanded_mode) mode = commanded_mode;
    });
    if (!mode) return;
    ExecutorState state;
    state.robot_id = "arm";
    state.mode = *mode;
    (void)states_.write(dds::encode(state));
  }

 private:
  dds::Entity publisher_;
  dds::Reader<fjr_msg_ExecutorCommand> commands_;
  dds::Writer<fjr_msg_ExecutorState> states_;
};

class HaltTest : public ServiceProcesses {
 protected:
  struct Outcome {
    int code;
    std::string text;
    Clock::time_point started;
  };

  // Runs the command while the executors play.
  Outcome run(std::vector<std::string> words, const std::vector<PlayedExecutor*>& executors) const {
    words.insert(words.end(), {"--find", "1.5", "--within", "3"});
    const auto started = Clock::now();
    const auto command = fjr(words, "halt.log");
    siginfo_t ended{};
    while (ended.si_pid == 0) {
      for (PlayedExecutor* executor : executors) executor->play();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ::waitid(P_PID, static_cast<id_t>(command->pid()), &ended, WEXITED | WNOHANG | WNOWAIT);
    }
    return {command->wait(), command->output(), started};
  }
};

TEST_F(HaltTest, SendsTheCommandWhateverIsHeard) {
  const dds::Participant here(domain_);
  PlayedExecutor silent(here);  // as one that hangs, or whose states are lost
  const Outcome hold = run({"hold"}, {&silent});
  EXPECT_EQ(hold.code, 1);
  EXPECT_GT(silent.commands, 3);
  EXPECT_THAT(hold.text, testing::ContainsRegex("hold was sent [0-9]+ times to 1 reader of commands, arrived, and no "
                                                "executor reports for robot 'arm'"));
  // Loading the program and meeting takes 0.1 s on an idle machine; a state to wait for would never come.
  const double delay = std::chrono::duration<double>(silent.first - hold.started).count();
  RecordProperty("delay_ms", static_cast<int>(delay * 1e3));
  std::printf("the command arrived %.0f ms after the start of the program\n", delay * 1e3);
  EXPECT_LT(delay, 1.5);
}

TEST_F(HaltTest, SucceedsOnlyWhenEveryExecutorOfTheRobotComplies) {
  const dds::Participant here(domain_), there(domain_);
  PlayedExecutor first(here), second(there);
  first.mode = second.mode = ExecutorMode::kExecuting;
  first.commanded_mode = ExecutorMode::kHolding;
  const Outcome one_goes_on = run({"hold"}, {&first, &second});
  EXPECT_EQ(one_goes_on.code, 1);
  EXPECT_THAT(one_goes_on.text, HasSubstr("1 of 2 executors of robot 'arm' says within 3 s that it complies"));
  EXPECT_GT(second.commands, 0);

  first.mode = second.mode = ExecutorMode::kExecuting;
  second.commanded_mode = ExecutorMode::kHolding;
  const Outcome both = run({"hold", "--json"}, {&first, &second});
  EXPECT_EQ(both.code, 0) << both.text;
  EXPECT_THAT(both.text, testing::ContainsRegex("executors.*holding.*holding"));

  const Outcome stop = run({"stop"}, {&first, &second});  // they hold, and do not say that they are stopped
  EXPECT_EQ(stop.code, 1);
  EXPECT_THAT(stop.text, HasSubstr("0 of 2 executors"));

  second.mode = second.commanded_mode = std::nullopt;
  first.mode = ExecutorMode::kExecuting;
  const Outcome one_is_silent = run({"hold"}, {&first, &second});
  EXPECT_EQ(one_is_silent.code, 1);
  EXPECT_THAT(one_is_silent.text, HasSubstr("1 more says nothing of itself"));
}

// An executor whose states cannot be read, beside one that can: it gets the command too, and is told of.
TEST_F(HaltTest, ReachesWhoCannotBeHeard) {
  const dds::Participant here(domain_), there(domain_);
  PlayedExecutor heard(here), elsewhere(there, "elsewhere");
  heard.mode = elsewhere.mode = ExecutorMode::kExecuting;
  heard.commanded_mode = elsewhere.commanded_mode = ExecutorMode::kStopped;
  const Outcome stop = run({"stop"}, {&heard, &elsewhere});
  EXPECT_EQ(stop.code, 1);
  EXPECT_GT(elsewhere.commands, 0);
  EXPECT_THAT(stop.text, HasSubstr("1 of 1 executors"));
  EXPECT_THAT(stop.text, HasSubstr("1 more says nothing of itself"));
}

// What an executor says before it can have the command is no answer to it: neither while nobody takes commands, nor
// what was on its way, or about to be said, when the command arrived.
TEST_F(HaltTest, BelievesNoStateOfBeforeTheCommand) {
  const dds::Participant here(domain_);
  dds::Writer<fjr_msg_ExecutorState> states(here, here.handle());
  std::optional<dds::Reader<fjr_msg_ExecutorCommand>> commands;
  std::optional<Clock::time_point> commanded;
  ExecutorState state;
  state.robot_id = "arm";
  state.mode = ExecutorMode::kHolding;
  const auto hold = fjr({"hold", "--find", "1", "--within", "3"}, "hold.log");
  std::optional<Clock::time_point> met;
  siginfo_t ended{};
  while (ended.si_pid == 0) {
    if (!met && states.has_reader()) met = Clock::now();
    // After the time in which it looks for whoever else is there.
    if (met && !commands && Clock::now() - *met > std::chrono::milliseconds(1500)) {
      commands.emplace(here, here.handle());
    }
    if (commands) {
      commands->take_all([&](const fjr_msg_ExecutorCommand&, const dds_sample_info_t& info) {
        if (info.valid_data && !commanded) commanded = Clock::now();
      });
    }
    const bool of_before = !commanded || Clock::now() - *commanded < std::chrono::milliseconds(15);
    state.mode = of_before ? ExecutorMode::kHolding : ExecutorMode::kExecuting;
    (void)states.write(dds::encode(state));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::waitid(P_PID, static_cast<id_t>(hold->pid()), &ended, WEXITED | WNOHANG | WNOWAIT);
  }
  EXPECT_TRUE(commanded);
  EXPECT_EQ(hold->wait(), 1) << hold->output();
  EXPECT_THAT(hold->output(), testing::ContainsRegex("hold was sent [0-9]+ times to 1 reader of commands, arrived, but "
                                                     "0 of 1 executors"));
}

// Without multicast, with DDS's own discovery, and by multicast as in a lab: in a network namespace of our own.
TEST_F(HaltTest, HoldsUnderEveryConfiguration) {
  if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) {
    GTEST_SKIP() << "no network of our own here";
  }
  Process up({"/bin/sh", "-c", "ip link set lo up multicast on"}, path("ip.log"));
  ASSERT_EQ(up.wait(), 0) << up.output();
  ::setenv("FJR_INTERFACE", "lo", 1);
  for (const char* uri : {"", "<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces></General>",
                          "file://" FJR_SOURCE_DIR "/config/cyclonedds-lab.xml"}) {
    ::setenv("CYCLONEDDS_URI", uri, 1);
    const auto executor = fjr({"executor", "--state", path("state")}, "executor.log");
    ASSERT_TRUE(comes_true([&] { return executor->output().find("executing for") != std::string::npos; }));
    const auto hold = fjr({"hold"}, "hold.log");
    EXPECT_EQ(hold->wait(), 0) << uri << hold->output();
    EXPECT_THAT(hold->output(), HasSubstr("arm: holding at"));
    executor->send(SIGTERM);
    EXPECT_EQ(executor->wait(), 0);
  }
}

}  // namespace
}  // namespace fjr
