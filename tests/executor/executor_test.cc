// The executor: a motion from the request to the simulated arm through real processes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "model/log.h"
#include "planner/certificate/certificate.h"
#include "planner/stop/stop_motion.h"
#include "tests/executor/executor_fixture.h"

namespace fjr {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(ExecutorTest, MovesTheArmAndThenRefusesToStartFromElsewhere) {
  Process service = fjr({"serve"}, "serve.log");
  const auto arm = executor();
  Process first = fjr({"request", path("there.yaml"), "--execute", "--out", path("out")}, "first.log");
  EXPECT_EQ(first.wait(), 0) << first.output() << arm->output();
  EXPECT_THAT(first.output(), HasSubstr("execution   code 0"));
  // The service tells the executor what the certificate predicts, and it does about as well.
  const auto predicted = nlohmann::json::parse(contents(path("out") / "plan.json"))
                             .at("/certificate/tracking/link_error_rad"_json_pointer)
                             .get<Joints<double>>();
  const std::string said = fmt::format("predicted=({:.2e}, {:.2e})", predicted[0], predicted[1]);
  EXPECT_THAT(arm->output(), HasSubstr(said));
  Joints<double> measured{};
  ASSERT_EQ(std::sscanf(first.output().substr(first.output().find("link error")).c_str(), "link error %lf and %lf",
                        &measured[0], &measured[1]),
            2);
  // The prediction begins exactly at rest, and knows nothing of ticks that a busy machine misses.
  const double beside = 5 * exactness_tolerance(load_parameters(default_robot_file()));
  EXPECT_LT(measured[0], predicted[0] + beside);
  EXPECT_LT(measured[1], predicted[1] + beside);

  Process second = fjr({"request", path("there.yaml"), "--execute"}, "second.log");
  EXPECT_EQ(second.wait(), 1) << second.output();
  // 0.42 rad but for what the motion ended beside it.
  EXPECT_THAT(second.output(), testing::ContainsRegex("starts at q1 = 0.3 rad, the arm is at 0.4(19[89]|2)"));

  // What a stopped arm would refuse is not planned first.
  Process stop = fjr({"stop"}, "stop.log");
  EXPECT_EQ(stop.wait(), 0) << stop.output();
  Process third = fjr({"request", path("there.yaml"), "--execute"}, "third.log");
  EXPECT_EQ(third.wait(), 1);
  EXPECT_THAT(third.output(), HasSubstr("the arm is stopped until it is started again"));
  EXPECT_THAT(third.output(), Not(HasSubstr("certified")));
  arm->send(SIGTERM);
  EXPECT_EQ(arm->wait(), 0);
}

// A motion that comes to `to` with resting links and motors, where springs that are not in balance with gravity pull
// link 1 back with 2.8 rad/s^2. Its torque is exact.
std::vector<Sample> turning_back(const Joints<double>& from, const Joints<double>& to, double duration) {
  // 6 s^5 - 17 s^6 + 16 s^7 - 5 s^8 and all its derivatives up to the fourth are 0 at 0. At 1 its value and its first
  // and third derivatives are 0, the second one is 2.
  const auto turn = [](double s, int k) {
    constexpr double kCoefficients[] = {6, -17, 16, -5};
    double sum = 0;
    for (int i = 5; i < 9; ++i) {
      double factor = kCoefficients[i - 5];
      for (int r = 0; r < k; ++r) factor *= i - r;
      sum += factor * std::pow(s, i - k);
    }
    return sum;
  };
  std::vector<Sample> rows = flat_motion(robot(), from, to, duration).samples;
  for (Sample& row : rows) {
    const double s = row.time / duration;
    const auto derivative = [&](int k) {
      Joints<double> value;
      for (std::size_t j = 0; j < kJoints; ++j) {
        value[j] = (k == 0 ? from[j] : 0) + (to[j] - from[j]) * smooth_step(s, k) / std::pow(duration, k);
      }
      value[0] -= 2 * turn(s, k) / std::pow(duration, k);
      return value;
    };
    const FlatPoint point =
        from_link_motion(robot(), {derivative(0), derivative(1), derivative(2), derivative(3), derivative(4)});
    row.state = point.state;
    row.torque = point.torque;
  }
  for (Sample* end : {&rows.front(), &rows.back()}) end->state.dq = end->state.dtheta = {};  // rounding is no motion
  return rows;
}

// What says that it is certified, and is not.
TEST_F(ExecutorTest, BelievesNobody) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const auto refused = [this](auto change, const Joints<double>& to, const std::string& sentence) {
    TrajectoryOrder order = cell().order(kFrom, to, 1.2);
    change(order.rows);
    const ExecutionResult result = cell().result(cell().publish(order));
    EXPECT_EQ(result.code, ResultCode::kInvalidGoal) << sentence;
    EXPECT_THAT(result.sentence, HasSubstr(sentence));
    EXPECT_LT(cell().farthest[0], 1e-3) << sentence;
    ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  };
  using Rows = std::vector<Sample>;
  refused([](Rows& rows) { rows[600].torque[0] = 1e4; }, kTo,
          "torque of joint 1 reaches 10000 at 0.600000 s, its limit is 12");
  refused(
      [](Rows& rows) {
        for (std::size_t i = 600; i < rows.size(); ++i) rows[i].state.q[0] += 0.5, rows[i].state.theta[0] += 0.5;
      },
      kTo, "dq1 disagrees with its position column by 5.00e+02 rad/s between 0.599000 s and 0.600000 s");
  refused([](Rows&) {}, {3.3, -0.3}, "link_position of joint 1 reaches 3.3 at 1.199");
  refused(
      [](Rows& rows) {
        for (Sample& row : rows) row.time *= 0.5;
      },
      kTo, "dtheta1 disagrees with its position column by");
  refused(
      [](Rows& rows) {
        rows = {rows.front(), rows.back()};
        rows.back().time = 0.05;
      },
      kTo, "row 1 is 0.05 s after the row before, 1e-07 to 0.005 s are allowed");
  refused([](Rows& rows) { rows[600].state.q[1] += 1e-3; }, kTo,
          "dq2 disagrees with its position column by 1.00e+00 rad/s between 0.599000 s and 0.600000 s");
  // Nothing is wrong with any row, but the torque does not move the arm like that.
  refused(
      [](Rows& rows) {
        for (Sample& row : rows) row.torque[0] += 2 * smooth_step(std::min(row.time, 1.2 - row.time) / 0.6, 0);
      },
      kTo, "dtheta1 changes by 2.03e-03 rad/s until 0.168000 s that the motor's acceleration does not explain");
  refused(
      [](Rows& rows) {
        for (Sample& row : rows) row.torque[0] += 0.1 * smooth_step(std::min(row.time, 1.2 - row.time) / 0.6, 0);
      },
      kTo, "closed loop: link 1 is up to");
  refused([](Rows& rows) { rows.resize(600); }, kTo, "does not end at rest");
  refused([](Rows& rows) { rows = turning_back(kFrom, kTo, 1.2); }, kTo,
          "does not end at rest: its last row has theta = (1.121");
  const RequestId good = cell().publish(kFrom, kTo, 1.2);
  EXPECT_EQ(cell().result(good).code, ResultCode::kSuccessful) << cell().result(good).sentence;
}

TEST_F(ExecutorTest, BeginsAtOnceWhenTheStopMotionsComeWithIt) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  TrajectoryOrder order = cell().order(kFrom, kBeyond, 5);
  const auto before = std::chrono::steady_clock::now();
  order.stops = stop_motions(robot(), {order.rows, {}}, {});
  const auto after = std::chrono::steady_clock::now();
  order.published = cell().order(kFrom, kTo, 1).published;
  const RequestId id = cell().publish_with_stops(order);
  ASSERT_TRUE(cell().wait([](const ExecutorState& s) { return s.mode == ExecutorMode::kExecuting; }));
  const auto begun = std::chrono::steady_clock::now();
  RecordProperty("start_ms", std::to_string(std::chrono::duration<double, std::milli>(begun - after).count()));
  // What the executor would have needed to find them, on the same machine with the same load; 50 ms are bench/'s.
  EXPECT_LT(begun - after, (after - before) / 4);
  ASSERT_TRUE(cell().wait_for_time(0.3));
  Process hold = fjr({"hold"}, "hold.log");
  EXPECT_EQ(hold.wait(), 0);
  EXPECT_THAT(cell().result(id).sentence, HasSubstr("hold was commanded"));
  cell().listen_for(0.3);
  EXPECT_EQ(cell().results[id].size(), 1U);  // of the two it was published on
}

TEST_F(ExecutorTest, ReliesOnNoStopMotionThatItHasNotChecked) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const auto stops = stop_motions(robot(), {cell().order(kFrom, kBeyond, 3).rows, {}}, {});
  const auto with = [&](auto change) {
    TrajectoryOrder order = cell().order(kFrom, kBeyond, 3);
    order.stops = stops;
    change(order.stops);
    return cell().result(cell().publish_with_stops(order));
  };
  // Refused at once where they are needed soon.
  EXPECT_THAT(with([](auto& s) { s.resize(3); }).sentence,
              HasSubstr("brings 3 stop motions; one every 0.02 s are 150"));
  EXPECT_THAT(with([](auto& s) { s[2].time = 0.06; }).sentence,
              HasSubstr("the stop motion at 0.040 s cannot be used: it begins at 0.06 s"));
  EXPECT_THAT(with([](auto& s) { s[2].duration = 0; }).sentence, HasSubstr("it takes 0 s, 0.05 to 1.5 s are allowed"));
  EXPECT_THAT(with([](auto& s) { s[2].free[0][0] = 1e9; }).sentence,
              HasSubstr("the stop motion at 0.040 s cannot be used: torque of joint 1 reaches"));
  EXPECT_LT(cell().farthest[0], 1e-3);
  // Later the motion ends by the last that is good.
  const ExecutionResult later = with([](auto& s) { s[75].free[0][0] += 1; });
  EXPECT_EQ(later.code, ResultCode::kPathToleranceViolated);
  EXPECT_THAT(later.sentence, HasSubstr("no checked stop motion was there from 1.46"));
  EXPECT_THAT(later.sentence, HasSubstr("the stop motion at 1.500 s cannot be used"));
  EXPECT_LT(later.residual_vibration[0], 2e-3);
  EXPECT_TRUE(cell().wait_for(ExecutorMode::kHolding));
}

TEST_F(ExecutorTest, HoldsOnCommandAndGoesOnFromThereButNotFromAMotion) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const RequestId unwanted = cell().publish(kFrom, kTo, 1.5);  // its stops take some tenths of a second to find
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kPreparing));
  EXPECT_EQ(cell().state.trajectory_id, unwanted);
  Process first_hold = fjr({"hold"}, "first_hold.log");
  EXPECT_EQ(first_hold.wait(), 0) << first_hold.output();
  EXPECT_THAT(cell().result(unwanted).sentence, HasSubstr("held or stopped before it could begin"));
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kHolding));
  EXPECT_LT(cell().farthest[0], 1e-3);

  const RequestId held = cell().publish(kFrom, kTo, 1.5);
  ASSERT_TRUE(cell().wait_for_time(0.5));
  const RequestId early = cell().publish(kTo, kFrom, 0.5);
  EXPECT_THAT(cell().result(early).sentence, HasSubstr("the arm is not at rest"));
  Process hold = fjr({"hold"}, "hold.log");
  EXPECT_EQ(hold.wait(), 0) << hold.output();
  EXPECT_THAT(hold.output(), HasSubstr("arm: holding at q = ("));
  EXPECT_EQ(cell().result(held).code, ResultCode::kGoalToleranceViolated);
  EXPECT_THAT(cell().result(held).sentence, HasSubstr("hold was commanded at"));
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kHolding));
  EXPECT_GT(cell().state.q[0], kFrom[0] + 0.01);
  EXPECT_LT(cell().state.q[0], kTo[0] - 0.01);

  const RequestId elsewhere = cell().publish(kTo, kFrom, 0.5);
  EXPECT_THAT(cell().result(elsewhere).sentence, HasSubstr("starts at q1"));
  const RequestId onwards = cell().publish(cell().state.q, kTo, 0.5);
  EXPECT_EQ(cell().result(onwards).code, ResultCode::kSuccessful) << cell().result(onwards).sentence;
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  EXPECT_NEAR(cell().state.q[0], kTo[0], 1e-3);
  cell().listen_for(0.2);
  for (const RequestId& id : {held, early, elsewhere, onwards}) EXPECT_EQ(cell().results[id].size(), 1U);
}

TEST_F(ExecutorTest, StopsUntilItIsRestarted) {
  auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const RequestId stopped = cell().publish(kFrom, kTo, 1.5);
  ASSERT_TRUE(cell().wait_for_time(0.4));
  Process stop = fjr({"stop", "--json"}, "stop.log");
  EXPECT_EQ(stop.wait(), 0) << stop.output();
  EXPECT_EQ(nlohmann::json::parse(stop.output()).at("mode"), "stopped");
  EXPECT_THAT(cell().result(stopped).sentence, HasSubstr("stop was commanded"));
  const RequestId refused = cell().publish(cell().state.q, kTo, 0.5);
  EXPECT_THAT(cell().result(refused).sentence, HasSubstr("stopped; it has to be restarted"));
  Process hold = fjr({"hold"}, "hold.log");  // is no way out of it
  EXPECT_EQ(hold.wait(), 0);
  EXPECT_THAT(hold.output(), HasSubstr("stopped until the executor is restarted"));
}

TEST_F(ExecutorTest, HoldSaysWhenThereIsNoExecutor) {
  Process hold = fjr({"hold", "--robot-id", "nobody"}, "hold.log");
  EXPECT_EQ(hold.wait(), 1);
  EXPECT_THAT(hold.output(), HasSubstr("no executor reports for robot 'nobody'"));
}

TEST_F(ExecutorTest, GivesEveryTrajectoryOneResult) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  std::vector<TrajectoryOrder> orders;
  for (int i = 0; i < 8; ++i) orders.push_back(cell().order(kFrom, kTo, 1));  // prepared in about half a second
  for (const TrajectoryOrder& order : orders) cell().publish(order);
  cell().publish(orders[0]);
  cell().publish(orders[3]);
  for (const TrajectoryOrder& order : orders) (void)cell().result(order.id);
  cell().listen_for(0.3);
  for (const TrajectoryOrder& order : orders) EXPECT_EQ(cell().results[order.id].size(), 1U) << order.id.number;
  EXPECT_EQ(cell().result(orders[0].id).code, ResultCode::kSuccessful) << cell().result(orders[0].id).sentence;
  for (std::size_t i = 1; i < orders.size(); ++i) {
    EXPECT_THAT(cell().result(orders[i].id).sentence,
                AnyOf(HasSubstr("another trajectory is being prepared"), HasSubstr("the arm is not at rest")));
  }
}

// As they come when it was kept from looking: here by being stopped, otherwise by the disk.
TEST_F(ExecutorTest, GivesEachOfManyThatComeTogetherAResult) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  std::vector<TrajectoryOrder> orders;
  for (int i = 0; i < 40; ++i) {  // of two rows each, for which the writer has room
    orders.push_back(cell().order(kFrom, kTo, 1));
    orders.back().rows.resize(2);
  }
  arm->send(SIGSTOP);
  for (const TrajectoryOrder& order : orders) cell().publish(order);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  arm->send(SIGCONT);
  for (const auto* one : {&orders.back(), &orders.front()}) (void)cell().result(one->id);
  cell().listen_for(0.3);
  for (const TrajectoryOrder& order : orders) EXPECT_EQ(cell().results[order.id].size(), 1U) << order.id.number;
}

TEST_F(ExecutorTest, ComesToRestBeforeItEnds) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const RequestId id = cell().publish(kFrom, kTo, 1.5);
  ASSERT_TRUE(cell().wait_for_time(0.4));
  arm->send(SIGTERM);
  const ExecutionResult result = cell().result(id);
  EXPECT_THAT(result.sentence, HasSubstr("the executor was ended"));
  EXPECT_LT(result.residual_vibration[0], 2e-3);
  EXPECT_EQ(arm->wait(), 0);
}

// A load that nobody told it of pulls the arm down while the motion is prepared.
TEST_F(ExecutorTest, DoesNotBeginElsewhereThanItWouldHaveWhenItWasAsked) {
  const auto arm = executor({"--payload", "0.5"});
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const Joints<double> from = cell().state.q;
  const ExecutionResult result = cell().result(cell().publish(from, kBeyond, 5));  // over a second to prepare
  const Joints<double> then = cell().state.q;
  EXPECT_EQ(result.code, ResultCode::kInvalidGoal)
      << from[0] << " " << from[1] << " then " << then[0] << " " << then[1];
  EXPECT_THAT(result.sentence, HasSubstr("when it could have begun: starts at q"));
}

TEST_F(ExecutorTest, LeavesALogThatCanBeReadAndAResultWithAllFigures) {
  const auto arm = executor({"--fast", "--hysteresis"});
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const ExecutionResult result = cell().result(cell().publish(kFrom, kTo, 0.6));
  ASSERT_EQ(result.code, ResultCode::kSuccessful) << result.sentence;
  ASSERT_EQ(result.limits.size(), 8U);
  for (const LimitMargin& margin : result.limits) {
    EXPECT_GT(margin.reached, 0) << margin.name;
    EXPECT_LT(margin.reached, margin.limit) << margin.name;
  }
  const Log log = read_log(result.log_file);
  EXPECT_EQ(log.metadata.at("robot_hash"), robot_hash(robot()));
  EXPECT_EQ(log.metadata.at("code"), "0");
  const auto &time = log.column("time"), &q1 = log.column("q1"), &plan = log.column("q1_plan");
  EXPECT_EQ(time.front(), 0);
  EXPECT_NEAR(time.back(), 0.6 + 0.5, 2e-3);
  double largest = 0;
  for (std::size_t i = 0; i < log.rows() && time[i] < 0.6; ++i) {
    largest = std::max(largest, std::abs(q1[i] - plan[i]));
    EXPECT_NEAR(time[i], 1e-3 * static_cast<double>(i), 1e-9);
  }
  EXPECT_NEAR(largest, result.link_error[0], 1e-9);
  EXPECT_TRUE(log.has("tau2_plan") && log.has("theta1_plan") && log.has("tau1"));
}

}  // namespace
}  // namespace fjr
