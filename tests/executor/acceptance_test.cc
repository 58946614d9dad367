// What the executor refuses, and that it takes what the planner certifies: every example that goes from rest to rest.
#include "planner/executor/acceptance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "planner/executor/executor_config.h"
#include "planner/executor/motion.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/stop/stop_motion.h"

namespace fjr {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;

Situation at_rest() {
  Situation situation;
  situation.robot_hash = "mine";
  situation.started = 100 * kSecond;
  situation.now = 200 * kSecond;
  situation.epoch = 3;
  situation.q = {0.3, 0.2};
  return situation;
}

TrajectoryOrder good() {
  TrajectoryOrder order;
  order.id.number = 1;
  order.robot_hash = "mine";
  order.epoch = 3;
  order.published = 199 * kSecond;
  order.certified = order.ends_at_rest = true;
  order.rows.resize(3);
  for (std::size_t i = 0; i < order.rows.size(); ++i) {
    order.rows[i].time = 0.001 * static_cast<double>(i);
    order.rows[i].state.q = {0.305, 0.195};
  }
  return order;
}

TEST(Acceptance, TakesWhatIsInOrder) { EXPECT_FALSE(refusal_of(good(), at_rest())); }

// Of rows that were learnt the motors' reference begins where they were, which is not where the model has them.
TEST(Acceptance, LearntRowsBeginWhereTheMotorsAre) {
  TrajectoryOrder order = good();
  for (Sample& row : order.rows) row.state.theta = {0.05, 0};
  Situation situation = at_rest();
  situation.theta = {0.05 + 0.9 * kStartTolerance, 0};
  EXPECT_TRUE(refusal_of(order, situation));
  order.learnt = true;
  EXPECT_FALSE(refusal_of(order, situation));
  situation.theta = {0.05 + 1.1 * kStartTolerance, 0};
  ASSERT_TRUE(refusal_of(order, situation));
  EXPECT_THAT(refusal_of(order, situation)->sentence, HasSubstr("starts with theta1 = 0.05 rad"));
}

TEST(Acceptance, RefusesWithTheReason) {
  const auto refused = [](auto change, ResultCode code, const std::string& sentence) {
    TrajectoryOrder order = good();
    Situation situation = at_rest();
    change(order, situation);
    const auto refusal = refusal_of(order, situation);
    ASSERT_TRUE(refusal) << sentence;
    EXPECT_EQ(refusal->code, code) << sentence;
    EXPECT_THAT(refusal->sentence, HasSubstr(sentence));
  };
  using Order = TrajectoryOrder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([](Order& o, Situation&) { o.robot_hash = "other"; }, ResultCode::kInvalidJoints, "another robot");
  refused([](Order& o, Situation&) { o.certified = false; }, ResultCode::kInvalidGoal, "not certified");
  refused([](Order& o, Situation&) { o.ends_at_rest = false; }, ResultCode::kInvalidGoal, "does not end at rest");
  refused([](Order& o, Situation&) { o.rows.resize(1); }, ResultCode::kInvalidGoal, "at least 2");
  refused([=](Order& o, Situation&) { o.rows[2].torque[1] = nan; }, ResultCode::kInvalidGoal, "row 2 is not finite");
  refused([](Order& o, Situation&) { o.rows[2].time = 0; }, ResultCode::kInvalidGoal,
          "time does not increase at row 2");
  refused([](Order& o, Situation&) { o.epoch = 2; }, ResultCode::kInvalidGoal, "from an earlier owner");
  refused([](Order& o, Situation&) { o.epoch = 4 + (1u << 24); }, ResultCode::kInvalidGoal,
          "epoch 16777220 is not that of an owner: the largest seen is 3");
  refused([=](Order& o, Situation&) { o.epoch = ~std::uint64_t{0}; }, ResultCode::kInvalidGoal, "not that of an owner");
  refused([](Order& o, Situation&) { o.rows[0].state.dq[0] = 1; }, ResultCode::kInvalidGoal, "does not begin at rest");
  refused([=](Order& o, Situation&) { o.tolerances.path[1] = nan; }, ResultCode::kInvalidGoal,
          "tolerances.path: nan is outside [0, 0.5]");
  refused([=](Order& o, Situation&) { o.tolerances.goal_time = -1; }, ResultCode::kInvalidGoal,
          "tolerances.goal_time: -1 is outside [0, 60]");
  refused([](Order& o, Situation&) { o.rows[0].state.theta[1] += 0.02; }, ResultCode::kInvalidGoal,
          "starts with theta2 = 0.02 rad, at rest there it is -0.005 rad");
  refused([](Order& o, Situation&) { o.rows[2].time = 1; }, ResultCode::kInvalidGoal,
          "row 2 is 0.999 s after the row before, 1e-07 to 0.005 s are allowed");
  refused([](Order& o, Situation&) { o.rows[2].time = o.rows[1].time + 1e-8; }, ResultCode::kInvalidGoal,
          "row 2 is 1e-08 s after the row before");
  refused(
      [](Order& o, Situation&) {
        o.rows.resize(5001);
        for (std::size_t i = 0; i < o.rows.size(); ++i) o.rows[i].time = 0.0042 * static_cast<double>(i);
      },
      ResultCode::kInvalidGoal, "takes 21 s, more than 20 s");
  refused([](Order& o, Situation&) { o.rows[0].time = -0.001; }, ResultCode::kInvalidGoal, "begins at -0.001 s");
  refused([](Order&, Situation& s) { s.mode = ExecutorMode::kPreparing; }, ResultCode::kInvalidGoal,
          "another trajectory is being prepared");
  refused([](Order& o, Situation&) { o.published = 201 * kSecond; }, ResultCode::kOldHeaderTimestamp,
          "1.000 s in the future");
  refused([](Order&, Situation& s) { s.mode = ExecutorMode::kStopped; }, ResultCode::kInvalidGoal, "was stopped");
  refused([](Order&, Situation& s) { s.lost = "theta2"; }, ResultCode::kInvalidGoal, "encoder theta2 gives no samples");
  refused([](Order& o, Situation&) { o.published = 99 * kSecond; }, ResultCode::kOldHeaderTimestamp, "before");
  refused([](Order&, Situation& s) { s.halted = 199 * kSecond + 1; }, ResultCode::kOldHeaderTimestamp,
          "published before the arm was told to hold");
  refused([](Order& o, Situation&) { o.published = 150 * kSecond; }, ResultCode::kOldHeaderTimestamp, "50.0 s ago");
  refused([](Order&, Situation& s) { s.mode = ExecutorMode::kExecuting; }, ResultCode::kInvalidGoal, "not at rest");
  refused([](Order&, Situation& s) { s.q[1] = 0.18; }, ResultCode::kInvalidGoal, "starts at q2 = 0.195 rad");
}

TEST(Acceptance, NeverRefusesWhatIsGenuine) {
  int executed = 0;
  for (const auto& entry : std::filesystem::directory_iterator(FJR_SOURCE_DIR "/config/requests")) {
    const Problem problem = load_request(entry.path(), default_robot_file());
    if (!problem.start_at_rest || !problem.goal.at_rest) continue;
    PlanOptions options;
    options.starts = 1;  // for the time it saves; where roundings make one start too few, as many as usual
    Plan planned = plan(problem, options);
    if (planned.status != PlanStatus::kCertified) planned = plan(problem, {});
    ASSERT_EQ(planned.status, PlanStatus::kCertified) << entry.path() << planned.reason;
    TrajectoryOrder order;
    order.robot_hash = robot_hash(problem.robot);
    order.certified = order.ends_at_rest = true;
    order.published = 0;
    order.rows = planned.trajectory->samples;
    order.stops = stop_motions(problem.robot, *planned.trajectory, {});
    Situation situation;
    situation.robot_hash = order.robot_hash;
    situation.q = order.rows.front().state.q;
    situation.rest_theta = order.rows.front().state.theta;
    const auto refusal = refusal_of(order, situation);
    EXPECT_FALSE(refusal) << entry.path() << refusal->sentence;
    EXPECT_NO_THROW((void)prepare(problem.robot, order, ExecutorConfig{}.tolerances, kLongestMotion, {}))
        << entry.path();
    ++executed;
  }
  EXPECT_GE(executed, 12);
}

}  // namespace
}  // namespace fjr
