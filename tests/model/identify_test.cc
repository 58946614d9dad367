// Each procedure on logs whose truth is known, and on logs that are not what they should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "common/normal.h"
#include "model/encoder.h"
#include "model/friction.h"
#include "model/identify/arm.h"
#include "model/identify/fit.h"
#include "tests/model/noisy_logs.h"

namespace fjr {
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& name, const Log& log, int joint) {
  try {
    identify_quietly(name, log, joint);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Identify, IdealLogsGiveTheTruth) {
  std::mt19937_64 random(4);
  const Rig rig = Rig::ideal(another_arm(random));
  const Parameters believed = wrong_by_half(rig.truth, random);
  std::vector<Estimate> estimates;
  for (const NamedRecord& r : short_experiments(rig, true)) {
    estimates.push_back(identify(r.name, measure(r.record, rig), r.joint, believed));
  }
  const Identified found = combine(believed, estimates);
  EXPECT_EQ(found.names.size(), 20U);
  for (const std::string& name : found.names) {
    const double truth = parameter(rig.truth, name);
    EXPECT_NEAR(parameter(found.robot, name), truth, 1e-3 * std::abs(truth)) << name;
  }
  for (const Estimate& e : estimates) EXPECT_EQ(warnings_of(e), "") << e.procedure;
}

TEST(Identify, UndeterminedShapeIsSaidWithABound) {
  const Estimate e = identify_quietly("motor_friction", noisy_log("motor_friction", 0), 0);
  EXPECT_EQ(e.assumed, std::vector<std::string>{"second_shape"});
  EXPECT_EQ(e.at("second_shape"), -6539.2);
  EXPECT_THAT(warnings_of(e), HasSubstr("h is not determined: no speed falls into its kink"));
  EXPECT_THAT(warnings_of(e), HasSubstr("kept from robot.yaml"));
  EXPECT_TRUE(identify_quietly("motor_friction", noisy_log("motor_friction", 1), 1).assumed.empty());
}

// The drive's own velocity is known to 2.5e-4 rad/s for one speed, the kink is 1.5e-4 rad/s wide: it would look three
// times as blunt, were the commands not trusted. Without them that is said.
TEST(Identify, AKinkNarrowerThanTheErrorOfASpeedIsNotBlunted) {
  const Rig rig = Rig::of(load_parameters(kRobot));
  Log log = measure(perform_motor_friction(rig, 0, ConstantSpeeds::of(0, true)), rig);
  const Estimate e = identify_misled("motor_friction", log, 0);
  EXPECT_TRUE(e.assumed.empty());
  EXPECT_LT(e.standard_error("second_shape"), 0.1 * 6539.2);
  EXPECT_NEAR(e.at("second_shape"), -6539.2, 4 * e.standard_error("second_shape"));
  for (double& v : log.column("dtheta1_plan")) v *= 1.1;  // a drive that does not do what it is told
  EXPECT_EQ(identify_quietly("motor_friction", log, 0).assumed, std::vector<std::string>{"second_shape"});
}

TEST(Identify, WrongSignsAreRefused) {
  for (const std::string column : {"tau1", "theta1"}) {
    EXPECT_THAT(error_of("stiffness", scaled(noisy_log("stiffness", 0), column, -1), 0), HasSubstr("wrong sign"));
  }
  EXPECT_THAT(error_of("gravity", scaled(noisy_log("gravity", 1), "q2", -1), 1), HasSubstr("wrong sign"));
  EXPECT_THAT(error_of("gravity", scaled(noisy_log("gravity", 1), "theta2", -1), 1), HasSubstr("wrong sign"));
  EXPECT_THAT(error_of("motor_friction", scaled(noisy_log("motor_friction", 0), "tau1", -1), 0),
              HasSubstr("wrong sign"));
  for (const std::string column : {"dtheta1", "tau1", "u1_plan"}) {
    EXPECT_THAT(error_of("motor_inertia", scaled(noisy_log("motor_inertia", 0), column, -1), 0),
                HasSubstr("wrong sign"));
  }
}

TEST(Identify, WrongUnitsAreRefusedWithAGuess) {
  const double degrees = 180 / M_PI;
  EXPECT_THAT(error_of("stiffness", scaled(noisy_log("stiffness", 0), "theta1", degrees), 0), HasSubstr("degrees"));
  EXPECT_THAT(error_of("gravity", scaled(noisy_log("gravity", 0), "q1", degrees), 0), HasSubstr("degrees"));
  EXPECT_THAT(error_of("stiffness", scaled(noisy_log("stiffness", 1), "tau2", 1000), 1), HasSubstr("mN m"));
  EXPECT_THAT(error_of("motor_friction", scaled(noisy_log("motor_friction", 1), "dtheta2", 60 / (2 * M_PI)), 1),
              HasSubstr("1/min"));
  EXPECT_THAT(error_of("motor_friction", scaled(noisy_log("motor_friction", 0), "theta1", degrees), 0),
              HasSubstr("degrees"));
  EXPECT_THAT(error_of("motor_inertia", scaled(noisy_log("motor_inertia", 1), "dtheta2", degrees), 1),
              HasSubstr("degrees"));
  Log slow = noisy_log("link_inertia", 0);
  for (double& t : slow.column("time")) t *= 1000;  // milliseconds
  EXPECT_THAT(error_of("link_inertia", slow, 0), HasSubstr("a time in milliseconds"));
  EXPECT_THAT(error_of("stiffness", scaled(noisy_log("stiffness", 0), "time", 1000), 0), HasSubstr("another unit?"));
  EXPECT_THAT(error_of("gravity", scaled(noisy_log("gravity", 1), "theta2", degrees), 1), HasSubstr("another unit"));
}

TEST(Identify, AnotherExperimentsLogIsRefused) {
  Log log = noisy_log("stiffness", 0);
  log.metadata["experiment"] = "gravity";
  EXPECT_THAT(error_of("stiffness", log, 0), HasSubstr("# experiment: is gravity, not stiffness"));
  log.metadata.clear();
  log.metadata["joint"] = "2";
  EXPECT_THAT(error_of("stiffness", log, 0), HasSubstr("# joint: is 2, not 1"));
  log.metadata.clear();
  EXPECT_THAT(error_of("stiffness", log, 1), HasSubstr("theta2: does not move"));
}

// One sample in 200 is nonsense, and one in 50 is missing.
Log spoiled(const Log& log, const std::vector<std::string>& columns) {
  Log bad = log;
  for (auto& values : bad.values) values.clear();
  for (std::size_t row = 0; row < log.rows(); ++row) {
    if (row % 50 == 17) continue;
    for (std::size_t i = 0; i < log.values.size(); ++i) bad.values[i].push_back(log.values[i][row]);
    if (row % 200 != 31) continue;
    for (const std::string& column : columns) bad.column(column).back() += 7;
  }
  return bad;
}

TEST(Identify, OutliersAndDroppedSamplesChangeLittleAndAreSaid) {
  const std::map<std::string, std::vector<std::string>> columns = {{"stiffness", {"tau1"}},
                                                                   {"gravity", {"tau1"}},
                                                                   {"link_inertia", {"q1"}},
                                                                   {"motor_friction", {"tau1"}},
                                                                   {"motor_inertia", {"dtheta1"}}};
  for (const auto& [name, spoiled_columns] : columns) {
    const Log& log = noisy_log(name, 0);
    const Estimate good = identify_quietly(name, log, 0);
    const Estimate bad = identify_quietly(name, spoiled(log, spoiled_columns), 0);
    for (Eigen::Index i = 0; i < good.value.size(); ++i) {
      EXPECT_NEAR(bad.value[i], good.value[i], 5e-3 * std::abs(good.value[i])) << name << " " << i;
    }
    EXPECT_THAT(warnings_of(bad), HasSubstr("rejected as outliers")) << name;
    EXPECT_THAT(warnings_of(bad), HasSubstr("samples are missing")) << name;
  }
}

// Without the optional columns (the drive's own velocity, what was commanded), or with one that is counts
// differentiated.
Log without_columns(const Log& log, bool velocity, bool planned) {
  Log bare = log;
  for (std::size_t i = bare.names.size(); i-- > 0;) {
    const std::string& name = bare.names[i];
    if ((velocity && (name == "dtheta1" || name == "dtheta2")) || (planned && name.ends_with("_plan"))) {
      bare.names.erase(bare.names.begin() + static_cast<std::ptrdiff_t>(i));
      bare.values.erase(bare.values.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  return bare;
}

Log with_differentiated_counts(Log log, int joint) {
  const std::vector<double>&theta = log.column(joint_column("theta", joint)), &time = log.column("time");
  std::vector<double>& v = log.column(joint_column("dtheta", joint));
  v[0] = 0;
  for (std::size_t i = 1; i < v.size(); ++i) v[i] = (theta[i] - theta[i - 1]) / (time[i] - time[i - 1]);
  return log;
}

void expect_friction_curve(const Log& log, int joint) {
  const Estimate e = identify_misled("motor_friction", log, joint);
  const FrictionLaw law{e.value[0], e.value[1], e.value[2], e.value[3], e.value[4]};
  const FrictionLaw truth = FrictionLaw::of(load_parameters(kRobot), joint);
  const double range = 2 * truth.torque(6.0);
  for (double v = 0.01; v <= 6; v *= 1.1) EXPECT_NEAR(law.torque(v), truth.torque(v), 0.02 * range) << v;
}

TEST(Identify, MotorsNeedNoOptionalColumn) {
  for (int joint = 0; joint < kJoints; ++joint) {
    const Log &friction = noisy_log("motor_friction", joint), &inertia = noisy_log("motor_inertia", joint);
    const double truth = load_parameters(kRobot).motor.inertia[static_cast<std::size_t>(joint)];
    // Where u is not logged it is found by the friction law, which is identified before.
    const Parameters known = combine(misled_robot(), {identify_misled("motor_friction", friction, joint)}).robot;
    for (const auto& [velocity, planned] : {std::pair{true, false}, {false, true}, {true, true}}) {
      expect_friction_curve(without_columns(friction, velocity, planned), joint);
      const Estimate e = identify("motor_inertia", without_columns(inertia, velocity, planned), joint, known);
      EXPECT_NEAR(e.at("inertia"), truth, 0.02 * truth) << joint << velocity << planned;
    }
    expect_friction_curve(with_differentiated_counts(friction, joint), joint);
    const Estimate e = identify("motor_inertia", with_differentiated_counts(inertia, joint), joint, known);
    EXPECT_NEAR(e.at("inertia"), truth, 0.02 * truth) << joint;
    EXPECT_EQ(e.residual_unit, "rad");  // theta was fitted
  }
}

// A link on a spring with the other standard hysteresis, which the virtual rig does not have: parallel elements that
// hold up to a yield each (Maxwell-slip). k = 1530/s^2, d = 0.86/s are those of link 2, stronger hysteresis than there.
TEST(Identify, MaxwellSlipHysteresisDoesNotEndUpInTheInertia) {
  constexpr double k = 1530, d = 0.86, height = 3, h = 5e-5;  // [1/s^2], [1/s], [rad/s^2] of all elements, [s]
  constexpr int kElements = 8;
  std::array<double, kElements> stretch{};
  Log log{"decay.csv", "", {}, {"time", "q1", "q2", "theta1", "theta2", "tau1", "tau2"}, {}};
  log.values.resize(log.names.size());
  double q = 0, dq = 8;
  for (int i = 0; i < 60000; ++i) {
    double slip = 0;
    for (int e = 0; e < kElements; ++e) {
      const double yield = 0.002 * (e + 0.5);
      double& x = stretch[static_cast<std::size_t>(e)];
      x = std::clamp(x + h * dq, -yield, yield);
      slip += x / (0.002 * kElements * kElements / 2);
    }
    dq += h * (-k * q - d * dq - height * slip);
    q += h * dq;
    if (i % 20 != 0) continue;
    const double values[] = {i * h, 0, quantised(q, 65536), 0, 0, 0, 0};
    for (std::size_t c = 0; c < log.values.size(); ++c) log.values[c].push_back(values[c]);
  }
  const Estimate e = identify_misled("link_inertia", log, 1);
  EXPECT_NEAR(e.at("stiffness_over_inertia"), k, 2e-3 * k);
  EXPECT_NEAR(e.at("damping_over_inertia"), d, 0.02 * d);
}

// The paper's staircase, told by nobody and begun when the log was already running.
TEST(Identify, StepsAreFoundWithoutMetadata) {
  const Rig rig = Rig::of(load_parameters(kRobot));
  for (int joint = 0; joint < kJoints; ++joint) {
    Staircase stairs{20, joint == 0 ? 0.3864 / 20 : 0.2262 / 20};
    stairs.period = 3;
    stairs.average = 1;
    const Record record = perform_stiffness(rig, joint, stairs);
    const Log log = measure(record, rig);
    Log late = log;
    late.metadata.clear();
    const auto lead = static_cast<std::size_t>(1.7 * stairs.sample_rate);  // at rest, then as before
    for (auto& values : late.values) values.insert(values.begin(), lead, values.front());
    for (std::size_t row = 0; row < late.rows(); ++row) {
      late.column("time")[row] = 5 + static_cast<double>(row) / stairs.sample_rate;
    }
    const Estimate found = identify_quietly("stiffness", late, joint);
    EXPECT_EQ(warnings_of(found), "");
    EXPECT_NEAR(found.value[0], identify_quietly("stiffness", log, joint).value[0], 0.005 * found.value[0]);
    EXPECT_EQ(found.points, identify_quietly("stiffness", log, joint).points);
  }
}

TEST(Identify, APeriodThatTheMotorContradictsIsSaid) {
  Log log = noisy_log("stiffness", 0);
  log.metadata["period"] = "1.5";
  log.metadata["average"] = "0.1";
  EXPECT_THAT(warnings_of(identify_quietly("stiffness", log, 0)), HasSubstr("the motor moves every 1 s"));
  log.metadata["average"] = "2";
  EXPECT_THAT(error_of("stiffness", log, 0), HasSubstr("# average: 2 s is longer than the period"));
}

}  // namespace
}  // namespace fjr
