// Stop motions of a plan that is at its limits nearly all the time, on the exact model.
#include "planner/stop/stop_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "planner/certificate/limits.h"
#include "planner/control/motor_feedback.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/stop/stop_limits.h"

namespace fjr {
namespace {

constexpr double kRest = 1;  // [s] watched after the stop

const Parameters& robot() {
  static const Parameters p = load_parameters(default_robot_file());
  return p;
}

// The plan up to the stop, the stop, and rest after it: what the arm is asked for altogether.
Trajectory with_stop(const Trajectory& plan, const Trajectory& stop) {
  Trajectory all;
  for (const Sample& row : plan.samples) {
    if (row.time < stop.start_time() - kJumpSpacing / 2) all.samples.push_back(row);
  }
  all.samples.insert(all.samples.end(), stop.samples.begin(), stop.samples.end());
  Sample rest = stop.samples.back();
  rest.time += kRest;
  all.samples.push_back(rest);
  return all;
}

// Of the executor's controller, ticks and encoders included.
struct Ticked {
  Joints<double> error{}, vibration{}, torque{};
};

Ticked run_ticks(const Trajectory& all, double end) {
  Ticked t;
  TickController controller(robot(), all);
  Interpolator plan(all);
  Rollout arm(robot(), Limits{}, Accuracy::of_predictions());
  State<double> x = all.samples.front().state;
  for (int k = 0; k * kTick < all.end_time(); ++k) {
    const TickController::Command command = controller.command(k * kTick, {x.theta, x.q});
    arm.start(0, x, Drive::holding({0, {}, command.torque}));
    EXPECT_TRUE(arm.run(kTick, {}, {}, {})) << arm.failure();
    x = arm.state();
    const double now = (k + 1) * kTick;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double error = std::abs(x.q[j] - plan.at(now).state.q[j]);
      t.error[j] = std::max(t.error[j], error);
      t.torque[j] = std::max(t.torque[j], std::abs(command.torque[j]));
      // The slow drift of a motor within its count is no swing: what is left when the offset at the end is taken away.
      if (now > end + kRest / 2) t.vibration[j] = std::max(t.vibration[j], std::abs(x.dq[j]));
    }
  }
  return t;
}

void expect_continuous(const Sample& plan, const Sample& stop, double time) {
  for (int i = 0; i < kStates; ++i) EXPECT_NEAR(stop.state[i], plan.state[i], 1e-9) << time << " " << i;
  for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(stop.torque[j], plan.torque[j], 1e-6) << time;
}

void expect_rest(const Sample& last) {
  const State<double> rest = rest_at(robot(), last.state.q);
  for (int i = 0; i < kStates; ++i) EXPECT_NEAR(last.state[i], rest[i], 1e-12);
}

TEST(StopMotion, LeavesTheLinksStillFromAnyInstantOfAFastPlan) {
  const Problem problem = parse_request("start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nobjective: fastest\n", "test", {},
                                        default_robot_file());
  const Plan fast = plan(problem, {});
  ASSERT_EQ(fast.status, PlanStatus::kCertified) << fast.reason;
  const std::vector<StopMotion> found = stop_motions(robot(), *fast.trajectory, {});
  ASSERT_EQ(found.size(), static_cast<std::size_t>(std::ceil(fast.trajectory->end_time() / kStopSpacing)));
  std::vector<Trajectory> stops;
  for (const StopMotion& stop : found) {
    stops.push_back(checked_stop(robot(), *fast.trajectory, stops.size(), stop));
  }
  ASSERT_GE(stops.size(), 20U);

  Interpolator at(*fast.trajectory);
  int own = 0;
  const Limits limits = stop_limits(robot());
  for (const Trajectory& stop : stops) {
    if (stop.samples.empty()) continue;
    ++own;
    expect_continuous(at.at(stop.start_time()), stop.samples.front(), stop.start_time());
    expect_rest(stop.samples.back());
    // No stop takes longer than the plan has to its own end.
    EXPECT_LE(stop.end_time(), fast.trajectory->end_time());

    // Independently of how the executor accepts it: to a certificate's accuracy, stopping at every corner, one second
    // of rest, from the true beginning of the plan.
    const Trajectory all = with_stop(*fast.trajectory, stop);
    Rollout rollout(robot(), rollout_allowance(robot(), limits), Accuracy::of_certificates());
    const Comparison closed =
        compare(rollout, robot(), all, Drive::closed_loop(all, robot()), comparison_instants(all));
    ASSERT_TRUE(closed.errors.completed) << closed.errors.failure;
    EXPECT_LE(closed.errors.max_link(), stop_exactness(robot())) << stop.start_time();
    for (const LimitCheck& check : check_limits(robot(), limits, all, closed)) {
      EXPECT_TRUE(check.passed) << stop.start_time() << ": " << violation(check);
    }

    const Ticked ticked = run_ticks(all, stop.end_time());
    for (std::size_t j = 0; j < kJoints; ++j) {
      // One and a half counts of the motor encoder: what feedback does not see, and how far it lets a motor go.
      EXPECT_LE(ticked.error[j], 1.5 * count_angle(robot().encoder.motor_counts[j])) << stop.start_time();
      EXPECT_LE(ticked.torque[j], robot().drive.peak_torque[j]);
      // A link of 0.3 m that swings one count of its encoder at its lowest frequency, 7 rad/s, has 7e-4 rad/s; motor 2
      // turning at a count's edge shakes link 2 by ten times that, at any rest.
      EXPECT_LE(ticked.vibration[j], 0.02) << stop.start_time() << " link " << j + 1;
    }
  }
  EXPECT_GE(own, 8);  // the rest is nearer to the plan's own end than to any stop
}

// What would be left if the links were simply braked: the same motion, its spring torque forgotten.
TEST(StopMotion, IsRefusedWhenItLeavesTheLinksSwinging) {
  const Sample start{0, rest_at(robot(), {0.3, 0.2}), gravity_torque(robot(), Joints<double>{0.3, 0.2})};
  Sample moving = start;
  moving.state.dq = moving.state.dtheta = {1, -1};
  const auto found = find_stop(robot(), moving, 0, 1);
  ASSERT_TRUE(found);
  const Trajectory stop = stop_rows(robot(), moving, *found);
  EXPECT_EQ(fault_of_stop(robot(), stop), std::nullopt);
  Trajectory broken = stop;
  for (Sample& row : broken.samples) row.torque[0] *= 0.95;
  EXPECT_NE(fault_of_stop(robot(), broken), std::nullopt);
}

TEST(StopMotion, SaysWhenThereIsNone) {
  // Far too fast to be stopped before the links' end position.
  Sample moving{0, rest_at(robot(), {3.1, 0}), {}};
  moving.state.dq = moving.state.dtheta = {5, 0};
  EXPECT_FALSE(find_stop(robot(), moving, 0, 1.5));
}

TEST(StopShape, AtRestStaysAtRest) {
  const Sample still{0, rest_at(robot(), {0.3, 0.2}), gravity_torque(robot(), Joints<double>{0.3, 0.2})};
  const auto stop = find_stop(robot(), still, 0, 1);
  ASSERT_TRUE(stop);
  for (const Sample& row : stop_rows(robot(), still, *stop).samples) {
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(row.state.q[j], still.state.q[j], 1e-12);
  }
}

}  // namespace
}  // namespace fjr
