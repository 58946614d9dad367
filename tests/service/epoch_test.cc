// Somebody without a name in an unsecured domain, who says what no owner can have come to: the robot stays in service.
#include <gmock/gmock.h>

#include <limits>
#include <optional>
#include <sstream>

#include "planner/dds/reader.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/wire_reply.h"
#include "planner/dds/writer.h"
#include "tests/executor/flat_motion.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();

// Speaks as a service and as an executor of the robot, and publishes trajectories, until it is gone.
class Liar {
 public:
  explicit Liar(unsigned domain)
      : participant_(domain),
        services_(participant_, participant_.handle()),
        executors_(participant_, participant_.handle()),
        trajectories_(participant_, participant_.handle()),
        results_(participant_, participant_.handle()) {}

  bool has_met_all() const { return services_.has_reader() && executors_.has_reader() && trajectories_.has_reader(); }
  bool has_met_service() const { return services_.has_reader() && executors_.has_reader(); }

  void say_as_service(std::uint64_t epoch) {
    ServiceStatus status;
    status.instance = "liar";
    status.robot_id = "arm";
    status.robot_hash = robot_hash(robot_);
    status.epoch = epoch;
    EXPECT_TRUE(services_.write(dds::encode(status)));
  }
  void say_as_executor(std::uint64_t epoch) {
    ExecutorState state;
    state.robot_id = "arm";
    state.robot_hash = robot_hash(robot_);
    state.epoch = epoch;
    EXPECT_TRUE(executors_.write(dds::encode(state)));
  }

  // What the executor answers to a motion from {0.3, 0.2} by an owner of that epoch.
  ExecutionResult publish(std::uint64_t epoch) {
    TrajectoryOrder order;
    order.robot_id = "arm";
    order.id = new_client();
    order.epoch = epoch;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    order.published = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    order.robot_hash = robot_hash(robot_);
    order.certified = order.ends_at_rest = true;
    order.rows = flat_motion(robot_, {0.3, 0.2}, {0.4, 0.2}, 0.5).samples;
    EXPECT_TRUE(trajectories_.write(dds::encode(order)));
    std::optional<ExecutionResult> result;
    EXPECT_TRUE(comes_true([&] {
      results_.take_all([&](const fjr_msg_ExecutionResult& message, const dds_sample_info_t& info) {
        if (info.valid_data && dds::decode(message).trajectory_id == order.id) result = dds::decode(message);
      });
      return result.has_value();
    }));
    return result.value_or(ExecutionResult{});
  }

 private:
  const Parameters robot_ = load_parameters(default_robot_file());
  dds::Participant participant_;
  dds::Writer<fjr_msg_PlannerStatus> services_;
  dds::Writer<fjr_msg_ExecutorState> executors_;
  dds::Writer<fjr_msg_Trajectory> trajectories_;
  dds::Reader<fjr_msg_ExecutionResult> results_;
};

class EpochTest : public ServiceProcesses {
 protected:
  std::unique_ptr<Process> executor() const {
    auto arm = fjr({"executor", "--start", "0.3,0.2", "--state", path("state")}, "executor.log");
    EXPECT_TRUE(comes_true([&] { return arm->output().find("executing for") != std::string::npos; }));
    return arm;
  }
  // Neither the executor nor the service is then near the end of what can be counted.
  void expect_motion() const {
    const auto request = fjr({"request", path("quick.yaml"), "--execute"}, "request.log");
    EXPECT_EQ(request->wait(), 0) << request->output();
    std::istringstream remembered(contents(path("state") / ("executor-" + std::to_string(domain_) + "-arm")));
    std::string word;
    std::uint64_t epoch = 0;
    EXPECT_TRUE(remembered >> word >> epoch) << remembered.str();
    EXPECT_LT(epoch, std::uint64_t{1} << 32);
  }
};

TEST_F(EpochTest, NobodyIsBelievedWhoIsFarAheadOfTheRobotsOwner) {
  const auto service = serve();
  const auto arm = executor();
  {
    Liar liar(domain_);
    ASSERT_TRUE(comes_true([&] { return liar.has_met_all(); }));
    for (const std::uint64_t epoch : {kLargest, kLargest - 1, kLargest / 2}) {
      EXPECT_THAT(liar.publish(epoch).sentence, HasSubstr("is not that of an owner: the largest seen is 0"));
    }
    for (const std::uint64_t epoch : {kLargest, kLargest - 1, kLargest / 2}) liar.say_as_service(epoch);
    EXPECT_TRUE(comes_true([&] { return service->output().find("not believed") != std::string::npos; }));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // leases of 300 and 500 ms
  expect_motion();
}

// Alone with the service it takes it wherever it likes, in steps that are small enough.
TEST_F(EpochTest, AServiceComesBackToWhatTheExecutorHasSeen) {
  const auto service = serve();
  {
    Liar liar(domain_);
    ASSERT_TRUE(comes_true([&] { return liar.has_met_service(); }));
    for (int step = 1; step < 100; ++step) {
      liar.say_as_service(static_cast<std::uint64_t>(step) << 24);
      liar.say_as_executor(static_cast<std::uint64_t>(step) << 24);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    liar.say_as_service(kLargest - 1);
    liar.say_as_executor(kLargest - 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  const auto arm = executor();
  expect_motion();
}

}  // namespace
}  // namespace fjr
