// What the planner certifies is executed: every example that goes from rest to rest passes all that the executor asks.
#include "planner/executor/acceptance.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "planner/executor/executor_config.h"
#include "planner/executor/motion.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/stop/stop_motion.h"

namespace fjr {
namespace {

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
