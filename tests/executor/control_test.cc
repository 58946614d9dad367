// The control tick on the simulated arm, on a simulated clock: modes, tolerances, faults, figures.
#include "planner/executor/control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "planner/certificate/tracking.h"
#include "planner/executor/executor_config.h"
#include "planner/executor/virtual_arm.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/stop/stop_motion.h"
#include "tests/executor/flat_motion.h"

namespace fjr {
namespace {

using testing::HasSubstr;

const Parameters& robot() {
  static const Parameters p = load_parameters(default_robot_file());
  return p;
}

const Joints<double> kFrom{0.3, 0.2}, kTo{0.9, -0.3};

TrajectoryOrder order(const Joints<double>& from, const Joints<double>& to, double duration) {
  TrajectoryOrder order;
  order.id.number = 7;
  order.rows = flat_motion(robot(), from, to, duration).samples;
  return order;
}

std::unique_ptr<CommandedMotion> without_stops(const Joints<double>& from, const Joints<double>& to,
                                               double duration = 0.6) {
  return prepare_without_stops(robot(), order(from, to, duration), ExecutorConfig{}.tolerances);
}

// From kFrom to kTo; the stops, which take time to find, are found once.
std::unique_ptr<CommandedMotion> motion() {
  static const std::vector<Trajectory> stops = [] {
    const Trajectory plan = flat_motion(robot(), kFrom, kTo, 0.6);
    std::vector<Trajectory> rows;
    for (const StopMotion& stop : stop_motions(robot(), plan, {})) {
      rows.push_back(checked_stop(robot(), plan, rows.size(), stop));
    }
    return rows;
  }();
  auto with_stops = without_stops(kFrom, kTo);
  with_stops->stops.emplace(stops);
  return with_stops;
}

// Arm and control, and what became of motions.
struct Rig {
  explicit Rig(VirtualArmOptions options = {}, const Joints<double>& q = kFrom) : arm(with_truth(options), q) {}

  static VirtualArmOptions with_truth(VirtualArmOptions options) {
    if (options.truth.link.length[0] == 0) options.truth = robot();
    return options;
  }

  void run(double seconds) {
    for (int i = 0; i < std::lround(seconds / kTick); ++i) {
      control.tick();
      while (const auto tick = control.state()) state = *tick;
    }
  }

  // Until it is over; its report.
  ExecutionResult finish(const CommandedMotion& motion) {
    for (int i = 0; i < 5000; ++i) {
      run(kTick);
      if (const auto finished = control.finished()) {
        EXPECT_EQ(*finished, &motion);
        return result_of(motion, robot());
      }
    }
    ADD_FAILURE() << "it never ends";
    return {};
  }

  VirtualArm arm;
  Control control{robot(), arm};
  TickState state;
};

TEST(Control, RunsAMotionAndRestsAtItsGoal) {
  Rig rig;
  rig.run(0.3);
  EXPECT_EQ(rig.state.mode, ExecutorMode::kResting);
  const auto move = motion();
  ASSERT_TRUE(rig.control.begin(move.get()));
  rig.run(0.3);
  EXPECT_EQ(rig.state.mode, ExecutorMode::kExecuting);
  EXPECT_GT(rig.state.dq[0], 1);        // midway of 0.6 rad in 0.6 s
  EXPECT_GT(rig.state.dtheta[0], 0.9);  // filtered, 5 ms late
  const ExecutionResult result = rig.finish(*move);
  EXPECT_EQ(result.code, ResultCode::kSuccessful) << result.sentence;
  EXPECT_EQ(rig.state.mode, ExecutorMode::kResting);
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_GT(result.link_error[j], 0);
    EXPECT_LT(result.link_error[j], 2e-3);
    EXPECT_LE(result.link_error_rms[j], result.link_error[j]);
    EXPECT_LT(result.residual_vibration[j], 2e-3);
    EXPECT_GT(result.feedback_torque[j], 0);
    EXPECT_NEAR(rig.state.q[j], kTo[j], 2e-3);
  }
  ASSERT_EQ(result.limits.size(), 8U);
  for (const LimitMargin& margin : result.limits) {
    EXPECT_GT(margin.reached, 0) << margin.name;
    EXPECT_LT(margin.reached, margin.limit) << margin.name;
  }
  EXPECT_EQ(move->log.size(), static_cast<std::size_t>(std::lround((0.6 + kWatched) / kTick)) + 1);
}

// What the certificate says of the executor: the largest link error of any run, from wherever the arm rests within its
// counts.
TEST(Control, TracksBetterThanPredicted) {
  struct Move {
    Joints<double> from, to;
    double duration;
  };
  for (const Move& move : {Move{{0.3, 0.2}, {0.9, -0.3}, 0.6}, Move{{1.2, -0.8}, {0.1, 0.4}, 0.9},
                           Move{{-0.4, 0.6}, {-0.2, -0.7}, 0.45}, Move{{2, 1}, {2.3, 0.8}, 0.4}}) {
    const Tracking predicted = predict_tracking(robot(), flat_motion(robot(), move.from, move.to, move.duration));
    const Tracking back = predict_tracking(robot(), flat_motion(robot(), move.to, move.from, move.duration));
    Rig rig({}, move.from);
    for (const double rest : {0.21, 0.83}) {
      for (const bool there : {true, false}) {
        rig.run(rest);
        const auto run =
            there ? without_stops(move.from, move.to, move.duration) : without_stops(move.to, move.from, move.duration);
        ASSERT_TRUE(rig.control.begin(run.get()));
        const ExecutionResult result = rig.finish(*run);
        ASSERT_EQ(result.code, ResultCode::kSuccessful) << result.sentence;
        for (std::size_t j = 0; j < kJoints; ++j) {
          const Tracking& said = there ? predicted : back;
          EXPECT_LT(result.link_error[j], said.link_error[j])
              << move.to[0] << " after " << rest << " s, link " << j + 1;
          EXPECT_LT(result.link_error_rms[j], said.link_error[j]);
          EXPECT_LT(result.residual_vibration[j], 1e-3);
        }
      }
    }
  }
}

// A motor within its count is brought to where the link encoder sees it, and motor 2 does not leave its rest.
TEST(Control, RestsWithinHalfACountOfTheLinkEncoder) {
  for (const Joints<double> q : {Joints<double>{0.3, 0.2}, Joints<double>{1.2, -0.8}, Joints<double>{-2, 1}}) {
    Rig rig({}, q);
    rig.run(0.5);
    for (int i = 0; i < 200; ++i) {
      rig.run(0.01);
      for (std::size_t j = 0; j < kJoints; ++j)
        EXPECT_NEAR(rig.arm.state().q[j], q[j], rest_error(robot(), j)) << q[0] << " " << j;
    }
  }
}

// Whenever it comes: at most 20 ms of the plan, then a stop, then stillness.
TEST(Control, HoldsFromAnyTick) {
  for (const int tick : {1, 37, 150, 200, 299, 301, 404, 555}) {
    Rig rig;
    const auto move = motion();
    ASSERT_TRUE(rig.control.begin(move.get()));
    rig.run(tick * kTick);
    rig.control.hold();
    rig.run(kTick);
    EXPECT_EQ(rig.state.mode, ExecutorMode::kStopping) << tick;
    const ExecutionResult result = rig.finish(*move);
    EXPECT_EQ(result.code, ResultCode::kGoalToleranceViolated);
    EXPECT_THAT(result.sentence, HasSubstr("hold was commanded"));
    EXPECT_EQ(rig.state.mode, ExecutorMode::kHolding);
    EXPECT_LT(move->log.size(), 2000U);
    Interpolator plan(move->trajectory);
    for (const LogRow& row : move->log) {  // it kept to the plan until 20 ms after the command at most, then left it
      const double off = std::abs(row.planned.state.q[0] - plan.at(row.time).state.q[0]);
      if (row.time <= tick * kTick) {
        EXPECT_EQ(off, 0) << tick << " at " << row.time;
      } else if (row.time > 0.3 && tick < 200) {
        EXPECT_GT(off, 0.01) << tick << " at " << row.time;
      }
    }
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_LT(result.residual_vibration[j], 2e-3) << tick;
    const Joints<double> held = rig.state.q;
    rig.run(0.5);
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(rig.state.q[j], held[j], 1e-3);
  }
}

TEST(Control, AStopIsForGoodAndAHoldIsNot) {
  Rig rig;
  const auto move = motion();
  ASSERT_TRUE(rig.control.begin(move.get()));
  rig.run(0.2);
  rig.control.hold();
  (void)rig.finish(*move);
  const auto onwards = without_stops(rig.state.q, kTo, 0.5);
  ASSERT_TRUE(rig.control.begin(onwards.get()));
  EXPECT_EQ(rig.finish(*onwards).code, ResultCode::kSuccessful);
  EXPECT_EQ(rig.state.mode, ExecutorMode::kResting);

  rig.control.stop();
  rig.run(kTick);
  EXPECT_EQ(rig.state.mode, ExecutorMode::kStopped);
  const auto never = without_stops(kTo, kFrom);
  ASSERT_TRUE(rig.control.begin(never.get()));
  EXPECT_EQ(rig.finish(*never).code, ResultCode::kInvalidGoal);
  EXPECT_EQ(rig.state.mode, ExecutorMode::kStopped);
}

TEST(Control, FollowsTheOffsetOfAStartThatIsNotQuiteWhereTheArmIs) {
  Rig rig({}, {0.305, 0.193});
  rig.run(0.2);
  const auto move = motion();
  ASSERT_TRUE(rig.control.begin(move.get()));
  const ExecutionResult result = rig.finish(*move);
  EXPECT_EQ(result.code, ResultCode::kSuccessful) << result.sentence;
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_NEAR(rig.state.q[j], kTo[j], 2e-3);
    EXPECT_LT(result.link_error[j], 9e-3);  // the offset itself
    // No kick: 7 mrad at once would be 7 rad/s in the filters, and together 2.6 and 0.7 N m; a count makes 0.5 and 0.3.
    EXPECT_LT(std::abs(move->log[0].torque[j] - move->log[0].planned.torque[j]), j == 0 ? 0.6 : 0.4);
  }
}

TEST(Control, StopsWhenALinkLeavesThePath) {
  Parameters heavy = robot();
  heavy.link.inertia[0] *= 4;
  Rig rig({.truth = heavy});
  const auto move = motion();
  ASSERT_TRUE(rig.control.begin(move.get()));
  const ExecutionResult result = rig.finish(*move);
  EXPECT_EQ(result.code, ResultCode::kPathToleranceViolated);
  EXPECT_THAT(result.sentence, HasSubstr("rad off the plan at"));
  EXPECT_EQ(rig.state.mode, ExecutorMode::kHolding);
  rig.run(1);
  EXPECT_LT(std::abs(rig.state.dq[0]), 0.5);  // links of a robot that nobody knows do swing
  EXPECT_LT(std::abs(rig.state.q[0] - move->ended_at[0]), 0.05);
}

TEST(Control, SaysWhenTheGoalIsNotReachedInTime) {
  Rig rig({.truth = robot(), .payload = 0.03});  // 3 mrad more deflection at the goal: within the path, off the goal
  auto move = motion();
  move->tolerances.goal = {0.001, 0.001};
  ASSERT_TRUE(rig.control.begin(move.get()));
  const ExecutionResult result = rig.finish(*move);
  EXPECT_EQ(result.code, ResultCode::kGoalToleranceViolated);
  EXPECT_THAT(result.sentence, HasSubstr("rad off the goal"));
  EXPECT_EQ(rig.state.mode, ExecutorMode::kHolding);
}

// Somebody who pushes a link while the goal is watched does not undo a stop.
TEST(Control, AStopWhileTheGoalIsWatchedStaysAStop) {
  Rig rig({.truth = robot(), .payload = 0.03});
  auto move = motion();
  move->tolerances.goal = {0.001, 0.001};  // the goal is watched, for it is not reached
  ASSERT_TRUE(rig.control.begin(move.get()));
  rig.run(0.65);
  EXPECT_FALSE(rig.control.finished());
  rig.control.stop();
  rig.run(kTick);
  move->tolerances.path = {1e-6, 1e-6};  // as if it were pushed
  EXPECT_EQ(rig.finish(*move).code, ResultCode::kPathToleranceViolated);
  EXPECT_EQ(rig.state.mode, ExecutorMode::kStopped);
}

class EncoderLoss : public testing::TestWithParam<EncoderFault::Encoder> {};
INSTANTIATE_TEST_SUITE_P(All, EncoderLoss,
                         testing::Values(EncoderFault::Encoder::kQ1, EncoderFault::Encoder::kQ2,
                                         EncoderFault::Encoder::kTheta1, EncoderFault::Encoder::kTheta2));

TEST_P(EncoderLoss, StopsAndHolds) {
  Rig rig({.truth = robot(), .fault = EncoderFault{GetParam(), 0.8}});
  const auto move = motion();
  ASSERT_TRUE(rig.control.begin(move.get()));
  const ExecutionResult result = rig.finish(*move);
  EXPECT_EQ(result.code, ResultCode::kPathToleranceViolated);
  EXPECT_THAT(result.sentence, HasSubstr("gave no more samples"));
  EXPECT_EQ(rig.state.mode, ExecutorMode::kHolding);
  ASSERT_NE(rig.state.lost, nullptr);
  // The feed-forward stop alone brings it to rest near where it was planned.
  const Sample& planned = move->log.back().planned;
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_NEAR(rig.arm.state().q[j], planned.state.q[j], 0.01);
    EXPECT_NEAR(rig.arm.state().dq[j], 0, 0.05);
  }
  const auto never = without_stops(rig.state.q, kTo);
  ASSERT_TRUE(rig.control.begin(never.get()));
  EXPECT_EQ(rig.finish(*never).code, ResultCode::kInvalidGoal);
}

// Behind encoders that now and then say nothing.
class Gaps : public Arm {
 public:
  explicit Gaps(Arm& arm) : arm_(arm) {}
  Reading read(int ticks) override {
    Reading reading = arm_.read(ticks);
    if (missing > 0 && missing-- > 0) reading.theta[1] = instead;
    return reading;
  }
  void command(const Joints<double>& torque) override { arm_.command(torque); }
  int missing = 0;
  std::optional<double> instead;  // of a reading that is missing

 private:
  Arm& arm_;
};

TEST(Control, BridgesTwoMissingSamplesAndNotMore) {
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  for (const std::optional<double> instead : {std::optional<double>(), std::optional(not_a_number)}) {
    for (const int missing : {kLostAfter - 1, kLostAfter}) {
      VirtualArm arm({.truth = robot()}, kFrom);
      Gaps gaps(arm);
      gaps.instead = instead;
      Control control(robot(), gaps);
      const auto move = motion();
      ASSERT_TRUE(control.begin(move.get()));
      for (int i = 0; i < 2500; ++i) {
        if (i == 300) gaps.missing = missing;
        control.tick();
      }
      ASSERT_TRUE(control.finished());
      EXPECT_EQ(move->outcome.ending, missing < kLostAfter ? Ending::kReached : Ending::kEncoderLost);
    }
  }
}

TEST(Control, HoldsWithFeedbackAgainWhenSamplesReturn) {
  VirtualArm arm({.truth = robot()}, kFrom);
  Gaps gaps(arm);
  Control control(robot(), gaps);
  const auto move = motion();
  ASSERT_TRUE(control.begin(move.get()));
  TickState state;
  double after = 0;  // largest feedback on the joint from when samples are back
  for (int i = 0; i < 3000; ++i) {
    if (i == 300) gaps.missing = 1500;
    control.tick();
    while (const auto tick = control.state()) state = *tick;
    if (i > 320 && i < 1799) {
      ASSERT_EQ(state.feedback[1], 0) << i;
    }
    if (i > 1801) after = std::max(after, std::abs(state.feedback[1]));
  }
  EXPECT_EQ(state.lost, nullptr);
  EXPECT_EQ(state.mode, ExecutorMode::kHolding);
  EXPECT_GT(after, 0);
  EXPECT_LT(after, 0.4);  // no kick: two counts, through gains and filter
  ASSERT_TRUE(control.finished());
  const auto onwards = without_stops(state.q, kTo);
  ASSERT_TRUE(control.begin(onwards.get()));
  for (int i = 0; i < 1500; ++i) control.tick();
  EXPECT_EQ(onwards->outcome.ending, Ending::kReached);
  EXPECT_TRUE(control.finished());
}

TEST(Control, BridgesFiveMissedTicks) {
  Rig rig;
  const auto move = motion();
  ASSERT_TRUE(rig.control.begin(move.get()));
  rig.run(0.2);
  rig.control.tick(1 + kStallTicks);
  EXPECT_EQ(rig.finish(*move).code, ResultCode::kSuccessful);
  EXPECT_EQ(move->missed_ticks, kStallTicks);
}

// In mid-motion, however long: the drives brake, nothing is pulled to where the plan is, and the links do not swing on
// their springs for ever. At rest they are within two counts of the motors' encoders of where they are held: the swing
// is stopped from motors that are anywhere within a count. From there the arm can be moved again.
TEST(Control, StopsWhereItIsAfterMoreMissedTicks) {
  for (const int missed : {kStallTicks + 1, 8, 40, 200, 3000}) {
    for (const double at : {0.15, 0.3, 0.45}) {
      SCOPED_TRACE(testing::Message() << missed << " missed at " << at << " s");
      Rig rig;
      const auto move = motion();
      ASSERT_TRUE(rig.control.begin(move.get()));
      rig.run(at);
      rig.control.tick(1 + missed);
      const Joints<double> found = rig.arm.state().q;
      const ExecutionResult result = rig.finish(*move);
      EXPECT_EQ(result.code, ResultCode::kPathToleranceViolated);
      EXPECT_THAT(result.sentence, HasSubstr(std::to_string(missed) + " control ticks in a row were missed at"));
      EXPECT_EQ(move->missed_ticks, missed);
      EXPECT_EQ(rig.state.mode, ExecutorMode::kHolding);
      for (std::size_t i = 1; i < move->log.size(); ++i) ASSERT_GT(move->log[i].time, move->log[i - 1].time);
      const Joints<double> held = rig.state.planned_q;
      for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(held[j], found[j], 0.4);  // 2.5 rad/s for 0.16 s
      for (int i = 0; i < 60; ++i) {                                                  // longer than a swing
        rig.run(0.01);
        for (std::size_t j = 0; j < kJoints; ++j) {
          EXPECT_NEAR(rig.arm.state().q[j], held[j], 2 * count_angle(robot().encoder.motor_counts[j]));
        }
      }
      const auto onwards = without_stops(held, kTo);
      ASSERT_TRUE(rig.control.begin(onwards.get()));
      EXPECT_EQ(rig.finish(*onwards).code, ResultCode::kSuccessful);
    }
  }
}

// A fastest motion leaves the springs at their limits and the links with 10 rad/s: no motion of the motors stops that
// within the limits, and they have to give way first. Measured: 2.25 counts and less.
TEST(Control, StopsTheSwingOfAFastestMotion) {
  const Plan fastest = plan(parse_request("start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\n", "reach", robot()), {});
  ASSERT_TRUE(fastest.trajectory);
  TrajectoryOrder fast;
  fast.id.number = 8;
  fast.rows = fastest.trajectory->samples;
  for (const int missed : {kStallTicks + 1, 20, 50, 1000, 3000}) {
    for (const double at : {0.1, 0.15, 0.2, 0.25, 0.3, 0.35}) {
      SCOPED_TRACE(testing::Message() << missed << " missed at " << at << " s");
      Rig rig({}, {0, 0});
      const auto move = prepare_without_stops(robot(), fast, ExecutorConfig{}.tolerances);
      ASSERT_TRUE(rig.control.begin(move.get()));
      rig.run(at);
      rig.control.tick(1 + missed);
      const ExecutionResult result = rig.finish(*move);
      EXPECT_THAT(result.sentence, HasSubstr("control ticks in a row were missed"));
      const Joints<double> held = rig.state.planned_q;
      for (int i = 0; i < 60; ++i) {  // longer than a swing
        rig.run(0.01);
        for (std::size_t j = 0; j < kJoints; ++j) {
          ASSERT_NEAR(rig.arm.state().q[j], held[j], 3 * count_angle(robot().encoder.motor_counts[j])) << i;
        }
      }
    }
  }
}

TEST(Control, StopsAgainWhereItIsWhenTicksAreMissedWhileItStops) {
  Rig rig;
  const auto move = motion();
  ASSERT_TRUE(rig.control.begin(move.get()));
  rig.run(0.3);
  rig.control.tick(1 + 40);
  rig.run(0.1);  // it is stopping the swing
  rig.control.tick(1 + 40);
  EXPECT_THAT(rig.finish(*move).sentence, HasSubstr("40 control ticks in a row were missed at 0.3"));
  for (int i = 0; i < 60; ++i) {
    rig.run(0.01);
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_NEAR(rig.arm.state().q[j], rig.state.planned_q[j], 2 * count_angle(robot().encoder.motor_counts[j]));
    }
  }
}

// Without one of the encoders nobody knows the swing: the motors stay where they are found.
TEST(Control, HoldsTheMotorsAfterMissedTicksWithoutAnEncoder) {
  VirtualArm arm({.truth = robot()}, kFrom);
  Gaps gaps(arm);
  Control control(robot(), gaps);
  const auto move = motion();
  ASSERT_TRUE(control.begin(move.get()));
  for (int i = 0; i < 300; ++i) control.tick();
  gaps.missing = 1500;
  control.tick(1 + 40);
  const Joints<double> found = arm.state().theta;
  for (int i = 0; i < 1200; ++i) control.tick();
  EXPECT_TRUE(control.finished());
  EXPECT_NEAR(arm.state().theta[0], found[0], 0.02);  // what friction holds against the gain
}

TEST(Control, RefusesToStartWithASignOrZeroThatCannotBe) {
  class Reversed : public VirtualArm {
   public:
    using VirtualArm::VirtualArm;
    Reading read(int ticks) override {
      Reading reading = VirtualArm::read(ticks);
      reading.theta[1] = -*reading.theta[1];
      return reading;
    }
  };
  Reversed arm({.truth = robot()}, kFrom);
  EXPECT_THAT([&] { Control(robot(), arm); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("encoders of joint 2 do not fit each other")));
}

TEST(VirtualArm, HangsLowerWithAPayloadAndTurnsBackLateWithHysteresis) {
  const Parameters loaded = with_payload(robot(), {0.2});
  // By hand: 0.2 kg at 0.345 and 0.305 m.
  EXPECT_NEAR(gravity_coefficients(loaded)[0], 6.17 + 0.2 * 9.8 * 0.345, 1e-12);
  EXPECT_NEAR(gravity_coefficients(loaded)[1], 0.53 + 0.2 * 9.8 * 0.305, 1e-12);
  const MassMatrix<double> m = mass_matrix(loaded, 0.0), before = mass_matrix(robot(), 0.0);
  EXPECT_NEAR(m.m11 - before.m11, 0.2 * 0.65 * 0.65, 1e-12);
  EXPECT_NEAR(m.m22 - before.m22, 0.2 * 0.305 * 0.305, 1e-12);

  VirtualArm plain({.truth = robot()}, kFrom), sticky({.truth = robot(), .hysteresis = Hysteresis{}}, kFrom);
  const Joints<double> more{gravity_torque(robot(), kFrom)[0] + 2, gravity_torque(robot(), kFrom)[1]};
  for (int i = 0; i < 100; ++i) {
    plain.command(more);
    sticky.command(more);
    (void)plain.read(1);
    (void)sticky.read(1);
  }
  EXPECT_GT(std::abs(plain.state().theta[0] - sticky.state().theta[0]), 1e-4);
}

}  // namespace
}  // namespace fjr
