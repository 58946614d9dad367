// Motions with time to spare: a pause is kept, and waiting costs nothing where friction holds the arm.
#include "planner/search/spare_time.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "model/dynamics.h"
#include "model/friction.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/search/continuation.h"
#include "planner/search/session.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

std::string effort(const std::string& from, const std::string& to, double duration) {
  return fmt::format("start: {{q: {}}}\ngoal: {{q: {}}}\nduration: {}\nobjective: {{effort: 1}}\nsearch: quick\n", from,
                     to, duration);
}

// Returns the effort of a certified plan, or infinity.
double effort_of(const std::string& yaml) {
  const Plan planned = plan(request(yaml), {});
  EXPECT_EQ(planned.status, PlanStatus::kCertified) << yaml << planned.reason;
  return planned.status == PlanStatus::kCertified ? planned.objective : kNoLimit;
}

// Returns a plan with a wait, from one start, and without a search for anything else.
WithWait with_wait(const std::string& yaml) {
  const Problem problem = request(yaml);
  SessionOptions options;
  options.jobs = 2;
  Session session(options);
  session.enter(Phase::kFinding);
  Findings found(problem);
  return plan_with_wait(1, found, session);
}

// Returns the time [s] in which no motor is faster than 1e-3 rad/s, five times what a pause allows.
double time_of_rest(const Trajectory& rows) {
  double time = 0;
  for (std::size_t i = 1; i < rows.samples.size(); ++i) {
    const Joints<double>& v = rows.samples[i].state.dtheta;
    if (std::max(std::abs(v[0]), std::abs(v[1])) < 1e-3) time += rows.samples[i].time - rows.samples[i - 1].time;
  }
  return time;
}

const std::string kDown = "[0, 0]", kUp = "[1.2, -0.8]", kLeft = "[-1.4607, -0.8498]", kRight = "[-0.6616, 1.249]";

TEST(SpareTime, AGuessStandsStillInItsPause) {
  const Problem problem = request(effort(kDown, kUp, 2));
  const Guess guess = minimum_jerk_guess(problem, 2), paused = paused_guess(guess, 0.5, 1.5);
  EXPECT_DOUBLE_EQ(paused.duration(), 3.5);
  for (const double time : {0.1, 0.49}) {
    EXPECT_NEAR(paused.state(time / 3.5).dq[0], guess.state(time / 2).dq[0], 1e-12) << time;
    EXPECT_NEAR(paused.state((time + 2) / 3.5).dq[0], guess.state((time + 0.5) / 2).dq[0], 1e-12) << time;
  }
  for (const double time : {0.51, 1.2, 1.99}) {
    const State<double> x = paused.state(time / 3.5);
    EXPECT_NEAR(x.q[0], guess.state(0.25).q[0], 1e-12) << time;
    EXPECT_EQ(x.dq[0], 0) << time;
    EXPECT_EQ(x.dtheta[1], 0) << time;
  }
}

// The bounds hold at collocation points, by 1e-9; between them a cubic may exceed them a little.
TEST(SpareTime, MotionsStandStillInAPause) {
  Problem problem = request(effort(kLeft, kRight, 2.7));
  const Pause pause{1.25, 1.45, 2e-4};
  problem.variation.pause = pause;
  Session session({});
  session.enter(Phase::kFinding);
  Continuation c(std::make_shared<const Problem>(problem), session, "test", {.by_interior_point = true});
  ASSERT_EQ(c.begin(starts_of(problem, 1, {}).guesses.front().guess, 400), StartOutcome::kNew);
  const Motion& motion = c.solution().motion;
  double fastest = 0;
  int still = 0;
  for (const Motion::Interval& interval : motion.intervals) {
    const State<double> x = motion.state_at(interval.start);
    const Joints<double> u = motion.torque_at(interval.start);
    const bool inside = pause.contains(interval.start + interval.duration / 2);
    still += inside;
    for (std::size_t j = 0; j < kJoints; ++j) {
      fastest = std::max(fastest, std::abs(x.dtheta[j]));
      if (!inside) continue;
      const double held = std::abs(FrictionLaw::of(problem.robot, static_cast<int>(j)).nonlinear(pause.speed));
      EXPECT_LE(std::abs(x.dq[j]), pause.speed + 1e-8) << interval.start;
      EXPECT_LE(std::abs(x.dtheta[j]), pause.speed + 1e-8) << interval.start;
      EXPECT_LE(std::abs(u[j]), held + 1e-8) << interval.start;
    }
  }
  EXPECT_GE(still, 2);
  EXPECT_GT(fastest, 1);  // it moves 2 rad in less than that many seconds
}

// Hanging takes no torque, so that waiting there is free: more time cannot cost more. Minima are told apart by
// 0.1 %.
TEST(SpareTime, WaitingAtTheStartOrGoalCostsNothing) {
  for (const auto& [from, to] : {std::pair{kDown, kUp}, std::pair{kUp, kDown}}) {
    const WithWait waiting = with_wait(effort(from, to, 10));
    ASSERT_TRUE(waiting.best) << from;
    EXPECT_TRUE(waiting.is_enough) << from;
    EXPECT_DOUBLE_EQ(waiting.best->trajectory.end_time(), 10) << from;
    EXPECT_LE(waiting.best->objective, 1.001 * effort_of(effort(from, to, 2.5))) << from;
  }
}

// One way is to go and hang, to wait there, and to go on. A pause elsewhere costs no more, if it is found: this one,
// from a single start, costs 1.7 % less. The usual search from twelve starts came to 2.4 times as much.
TEST(SpareTime, PausingOnTheWayCostsNoMoreThanToHangInBetween) {
  const double there = effort_of(effort(kLeft, kDown, 1.25)), onward = effort_of(effort(kDown, kRight, 1.25));
  const WithWait pausing = with_wait(effort(kLeft, kRight, 15));
  ASSERT_TRUE(pausing.best);
  EXPECT_FALSE(pausing.is_enough);
  EXPECT_LE(pausing.best->objective, there + onward);
  EXPECT_GE(time_of_rest(pausing.best->trajectory), 12);  // of 15 s, of which 2.5 s are for moving
}

TEST(SpareTime, IsLeftToTheUsualSearchWhereItIsNone) {
  EXPECT_FALSE(with_wait(effort(kDown, kUp, 2)).best);  // hardly enough time
  const std::string move = "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\n";
  EXPECT_FALSE(with_wait(move + "duration: 10\nobjective: {energy: 1}\n").best);  // slower motions cost less
  EXPECT_FALSE(with_wait(move + "duration: {min: 1, max: 10}\nobjective: {effort: 1, time: 1}\n").best);
}

}  // namespace
}  // namespace fjr
