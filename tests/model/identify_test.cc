// Each procedure on logs whose truth is known, and on logs that are not what they should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/chart_page.h"
#include "common/input_error.h"
#include "common/normal.h"
#include "model/encoder.h"
#include "model/friction.h"
#include "model/identify/agreement.h"
#include "model/identify/arm.h"
#include "model/identify/fit.h"
#include "model/identify/repeated.h"
#include "model/identify/report.h"
#include "model/identify/robot_file.h"
#include "tests/model/virtual_lab.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kRobot = FJR_SOURCE_DIR "/config/robot.yaml";

// Logs of one noisy lab, made once; another seed is another day, with other noise.
const Log& noisy_log(const std::string& name, int joint, std::uint64_t seed = 1) {
  static const Rig shipped = Rig::of(load_parameters(kRobot));
  static const std::vector<NamedRecord> records = short_experiments(shipped, false);
  static std::map<std::string, Log> logs;
  Rig rig = shipped;
  rig.seed = seed;
  for (const NamedRecord& r : records) {
    if (r.name == name && r.joint == joint) {
      return logs.try_emplace(name + std::to_string(joint) + std::to_string(seed), measure(r.record, rig))
          .first->second;
    }
  }
  throw std::logic_error("no log of " + name);
}

Estimate identify_quietly(const std::string& name, const Log& log, int joint) {
  return identify(name, log, joint, load_parameters(kRobot));
}

// By somebody who is 10 to 50 % wrong about everything that is to be found.
Parameters misled_robot() {
  std::mt19937_64 random(5);
  return wrong_by_half(load_parameters(kRobot), random);
}

Estimate identify_misled(const std::string& name, const Log& log, int joint) {
  return identify(name, log, joint, misled_robot());
}

std::string error_of(const std::string& name, const Log& log, int joint) {
  try {
    identify_quietly(name, log, joint);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string warnings_of(const Estimate& e) {
  std::string all;
  for (const std::string& warning : e.warnings) all += warning + "\n";
  return all;
}

Log scaled(Log log, const std::string& column, double factor) {
  for (double& value : log.column(column)) value *= factor;
  return log;
}

// A certified linear regression: Longley's would need six regressors; Norris (NIST StRD) shows the digits as well.
TEST(LinearFit, AgreesWithTheCertifiedNorrisRegression) {
  const double y[] = {.1, 338.8, 118.1, 888.0, 9.2,   228.1, 668.5, 998.5, 449.1, 778.9, 559.2, .3,
                      .1, 778.1, 668.8, 339.3, 448.9, 10.8,  557.7, 228.3, 998.0, 888.8, 119.6, .3,
                      .6, 557.6, 339.3, 888.0, 998.5, 778.9, 10.2,  117.6, 228.9, 668.4, 449.2, .2};
  const double x[] = {.2, 337.4, 118.2, 884.6, 10.1,  226.5, 666.3, 996.3, 448.6, 777.0, 558.2, .4,
                      .6, 775.5, 666.9, 338.0, 447.5, 11.6,  556.0, 228.1, 995.8, 887.6, 120.2, .3,
                      .3, 556.8, 339.1, 887.2, 999.0, 779.0, 11.1,  118.3, 229.2, 669.1, 448.9, .5};
  Eigen::MatrixXd a(36, 2);
  Eigen::VectorXd b(36);
  for (Eigen::Index i = 0; i < 36; ++i) {
    a.row(i) << 1, x[i];
    b[i] = y[i];
  }
  const Fit fit = linear_fit(a, b);
  EXPECT_NEAR(fit.value[0], -0.262323073774029, 1e-12);
  EXPECT_NEAR(fit.value[1], 1.00211681802045, 1e-13);
  EXPECT_NEAR(std::sqrt(fit.covariance(0, 0)), 0.232818234301152, 1e-11);
  EXPECT_NEAR(std::sqrt(fit.covariance(1, 1)), 0.429796848199937e-3, 1e-14);
}

TEST(LinearFit, SaysWhenTheDataDoNotDetermineEverything) {
  Eigen::MatrixXd a(4, 2);
  a << 1, 2, 2, 4, 3, 6, 4, 8;
  EXPECT_FALSE(linear_fit(a, Eigen::VectorXd::Ones(4)).determined);
}

TEST(CurveFit, FindsAnExponentialAndItsUncertainty) {
  const Residuals residuals = [](const Eigen::VectorXd& p, Eigen::VectorXd& r) {
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const double t = 0.1 * static_cast<double>(i);
      r[i] = p[0] * std::exp(-p[1] * t) - 2 * std::exp(-0.7 * t) - (i % 2 == 0 ? 1e-3 : -1e-3);
    }
  };
  const Fit fit = curve_fit(residuals, 50, Eigen::Vector2d(1, 1));
  EXPECT_NEAR(fit.value[0], 2, 1e-3);
  EXPECT_NEAR(fit.value[1], 0.7, 1e-3);
  EXPECT_NEAR(fit.residual_rms, 1e-3, 1e-5);
  EXPECT_LT(std::sqrt(fit.covariance(1, 1)), 1e-3);
}

// A line through noise that stays the same for 50 samples at a time: of 1000 samples only 20 are independent.
TEST(LinearFit, CorrelatedResidualsAreNotTakenForIndependentOnes) {
  constexpr int kSamples = 1000, kSame = 50, kRepetitions = 100;
  Normal normal(5);
  double square = 0, told = 0, naive = 0;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    Eigen::MatrixXd a(kSamples, 2);
    Eigen::VectorXd b(kSamples);
    double noise = 0;
    for (Eigen::Index i = 0; i < kSamples; ++i) {
      if (i % kSame == 0) noise = normal();
      a.row(i) << 1, static_cast<double>(i) / kSamples;
      b[i] = noise;
    }
    Fit fit = linear_fit(a, b);
    square += fit.value[1] * fit.value[1] / kRepetitions;
    naive += fit.covariance(1, 1) / kRepetitions;
    allow_for_correlation(fit);
    told += fit.covariance(1, 1) / kRepetitions;
  }
  EXPECT_LT(naive, 0.05 * square);
  EXPECT_GT(told, 0.6 * square);  // 20 clusters: known to be a little small
  EXPECT_LT(told, 1.4 * square);
}

TEST(RobustMean, ForgetsOutliersAndKeepsCounts) {
  EXPECT_NEAR(robust_mean(std::vector<double>{1, 1.1, 0.9, 1, 1.05, 0.95, 50}).mean, 1, 1e-12);
  EXPECT_EQ(robust_mean(std::vector<double>{1, 1.1, 0.9, 1, 1.05, 0.95, 50}).rejected, 1U);
  EXPECT_NEAR(robust_mean(std::vector<double>{2, 2, 2, 2.001, 2, 2}).mean, 2 + 0.001 / 6, 1e-12);
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

// A folder of this test's own, gone with it.
class RobotFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path write(const std::string& text) const {
    std::ofstream(folder_ / "robot.yaml") << text;
    return folder_ / "robot.yaml";
  }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("fjr_robot_" + std::to_string(getpid()));
};

TEST_F(RobotFile, IsCompleteAndLoads) {
  const Rig rig = Rig::of(load_parameters(kRobot));
  std::vector<Estimate> estimates;
  for (const NamedRecord& r : short_experiments(rig, false)) {
    Log log = measure(r.record, rig);
    log.source = r.name + ".csv";
    log.hash = "0123abcd";
    estimates.push_back(identify(r.name, log, r.joint, rig.truth));
  }
  const Identified found = combine(load_parameters(kRobot), estimates);
  const std::string text = format_robot(found, kRobot, false);
  EXPECT_EQ(robot_hash(load_parameters(write(text))), robot_hash(found.robot));
  EXPECT_THAT(text, HasSubstr("identified: gravity.csv sha256 0123abcd"));
  EXPECT_THAT(text, HasSubstr("identified but not used: joint 1: 0.25"));
  EXPECT_EQ(load_parameters(write(text)).link.damping, (Joints<double>{0, 0}));
  const Parameters damped = load_parameters(write(format_robot(found, kRobot, true)));
  EXPECT_NEAR(damped.link.damping[0], 0.2516, 1e-3);
  EXPECT_NEAR(damped.link.damping[1], 0.01, 1e-4);
}

TEST_F(RobotFile, TakesTheBoundWhereTheKnownShapeContradictsTheLog) {
  Parameters known = load_parameters(kRobot);
  known.friction.second_shape[0] = -20;
  const std::vector<Estimate> one = {identify("motor_friction", noisy_log("motor_friction", 0), 0, known)};
  EXPECT_THAT(warnings_of(one[0]), HasSubstr("is this bound"));
  const Identified found = combine(known, one);
  EXPECT_LT(found.robot.friction.second_shape[0], -50);
  EXPECT_THAT(found.names, testing::Not(testing::Contains("friction.second_shape[0]")));
  const std::string text = format_robot(found, kRobot, false);
  EXPECT_EQ(load_parameters(write(text)).friction.second_shape, found.robot.friction.second_shape);
  EXPECT_THAT(text, HasSubstr("joint 1 only bounded by its log: the bound"));
}

// ---- what experiments say of each other ----

std::vector<Estimate> motor_estimates(const Log& friction, const Log& inertia) {
  return {identify_quietly("motor_friction", friction, 0), identify_quietly("motor_inertia", inertia, 0)};
}

TEST(Agreement, TwoExperimentsTellTheSameViscousFriction) {
  const std::vector<Estimate> estimates =
      motor_estimates(noisy_log("motor_friction", 0), noisy_log("motor_inertia", 0));
  const std::vector<Agreement> found = agreements(estimates);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].parameter, "viscous, joint 1");
  EXPECT_LT(found[0].standard_errors_apart(), kDoubtfulApart);
  for (const Change& change : changes(load_parameters(kRobot), combine(load_parameters(kRobot), estimates))) {
    EXPECT_FALSE(change.is_large()) << change.sentence();
  }
}

TEST(Agreement, ADoubledTorqueContradictsTheOtherExperiment) {
  const std::vector<Estimate> estimates =
      motor_estimates(noisy_log("motor_friction", 0), scaled(noisy_log("motor_inertia", 0), "u1_plan", 2));
  const std::vector<Agreement> found = agreements(estimates);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].standard_errors_apart(), 10 * kContradictoryApart);
  EXPECT_THAT(found[0].sentence(), HasSubstr("viscous, joint 1: motor_friction says 0.4"));
  EXPECT_THAT(found[0].sentence(), HasSubstr("motor_inertia says 0.99"));
}

// ---- several logs of one experiment ----

Log stiffness_log(std::uint64_t seed) {
  Log log = noisy_log("stiffness", 0, seed);
  log.source = "stiffness_" + std::to_string(seed) + ".csv";
  return log;
}

TEST(Repeated, LogsOfOneExperimentAreComparedAndCombinedByTheirWeights) {
  const std::vector<Estimate> two = {identify_quietly("stiffness", stiffness_log(1), 0),
                                     identify_quietly("stiffness", stiffness_log(2), 0)};
  const std::vector<Agreement> found = agreements(two);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_LT(found[0].standard_errors_apart(), kDoubtfulApart);
  EXPECT_EQ(found[0].first, "stiffness (stiffness_1.csv)");
  EXPECT_EQ(found[0].second, "stiffness (stiffness_2.csv)");
  const Identified both = combine(load_parameters(kRobot), two);
  EXPECT_EQ(both.names, std::vector<std::string>{"spring.stiffness[0]"});
  EXPECT_EQ(both.from.at("spring.stiffness[0]").size(), 2U);
  const double a = 1 / two[0].covariance(0, 0), b = 1 / two[1].covariance(0, 0);
  const double mean = (a * two[0].value[0] + b * two[1].value[0]) / (a + b);
  const double chi_square = std::pow(two[0].value[0] - two[1].value[0], 2) / (1 / a + 1 / b);
  EXPECT_NEAR(both.robot.spring.stiffness[0], mean, 1e-12 * mean);
  EXPECT_NEAR(both.covariance(0, 0), std::max(chi_square, 1.0) / (a + b), 1e-9 / (a + b));
}

// Two that contradict each other are no more certain together than half of what they differ by.
TEST(Repeated, LogsThatContradictEachOtherAreSaidAndDoubted) {
  const std::vector<Estimate> two = {identify_quietly("stiffness", stiffness_log(1), 0),
                                     identify_quietly("stiffness", scaled(stiffness_log(2), "tau1", 1.2), 0)};
  const std::vector<Agreement> found = agreements(two);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].standard_errors_apart(), kContradictoryApart);
  const double apart = std::abs(two[0].value[0] - two[1].value[0]);
  EXPECT_GT(std::sqrt(combine(load_parameters(kRobot), two).covariance(0, 0)), 0.45 * apart);
}

TEST(Repeated, ALogWithCreepingSpeedsAddsWhatAnotherLeavesOpen) {
  const Rig rig = Rig::of(load_parameters(kRobot));
  const Log slow = measure(perform_motor_friction(rig, 0, ConstantSpeeds::of(0, true)), rig);
  const std::vector<Estimate> two = {identify_quietly("motor_friction", noisy_log("motor_friction", 0), 0),
                                     identify_misled("motor_friction", slow, 0)};
  ASSERT_FALSE(two[0].assumed.empty());
  ASSERT_TRUE(two[1].assumed.empty());
  const Estimate both = combine_repeated(two).front().estimate;
  EXPECT_TRUE(both.assumed.empty());
  EXPECT_NEAR(both.at("second_shape"), -6539.2, 4 * both.standard_error("second_shape"));
  for (const char* name : {"viscous", "amplitude", "width"}) {
    EXPECT_LE(both.standard_error(name), 1.0001 * two[0].standard_error(name)) << name;
    EXPECT_LE(both.standard_error(name), 1.0001 * two[1].standard_error(name)) << name;
  }
}

TEST(Repeated, TheSameLogTwiceIsRefused) {
  Log log = stiffness_log(1);
  log.hash = "0123abcd";
  const std::vector<Estimate> same = {identify_quietly("stiffness", log, 0), identify_quietly("stiffness", log, 0)};
  EXPECT_THROW(combine_repeated(same), InputError);
}

TEST(Repeated, WhatIsNoNumberAgreesWithNothing) {
  std::vector<Estimate> two = {identify_quietly("stiffness", stiffness_log(1), 0),
                               identify_quietly("stiffness", stiffness_log(2), 0)};
  two[1].covariance(0, 0) = NAN;
  EXPECT_GT(agreements(two).front().standard_errors_apart(), kContradictoryApart);
  EXPECT_THROW(combine_repeated(two), InputError);
  two[1].covariance(0, 0) = 0;
  EXPECT_THROW(combine_repeated(two), InputError);
  EXPECT_EQ((Agreement{"B", "", "a", "b", 0.5, 0, 0.5, 0}.standard_errors_apart()), 0);
}

// What no other experiment contradicts is told by the robot known before.
TEST(Agreement, AColumnInErrorIsALargeChange) {
  const auto large_changes = [](const std::string& name, const Log& log) {
    const Parameters known = load_parameters(kRobot);
    const std::vector<Estimate> one = {identify_quietly(name, log, 0)};
    std::string all;
    for (const Change& change : changes(known, combine(known, one))) {
      if (change.is_large()) all += change.sentence() + "\n";
    }
    return all;
  };
  EXPECT_EQ(large_changes("stiffness", noisy_log("stiffness", 0)), "");
  EXPECT_THAT(large_changes("stiffness", scaled(noisy_log("stiffness", 0), "tau1", 5)),
              HasSubstr("spring.stiffness[0] is 10"));
  EXPECT_THAT(large_changes("stiffness", scaled(noisy_log("stiffness", 0), "theta1", 0.5)),
              HasSubstr("spring.stiffness[0] is 4"));
  EXPECT_THAT(large_changes("gravity", scaled(noisy_log("gravity", 0), "tau1", 5)),
              HasSubstr("link.gravity_torque[0]"));
  EXPECT_THAT(large_changes("motor_friction", scaled(noisy_log("motor_friction", 0), "tau1", 5)),
              HasSubstr("friction.amplitude[0]"));
  EXPECT_THAT(large_changes("link_inertia", scaled(noisy_log("link_inertia", 0), "time", 1.5)),
              HasSubstr("link.inertia[0]"));
  EXPECT_THAT(large_changes("motor_inertia", scaled(noisy_log("motor_inertia", 0), "u1_plan", 1.5)),
              HasSubstr("motor.inertia[0]"));
}

std::size_t count_of(const std::string& part, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++count;
  return count;
}

std::string full_report() {
  std::vector<Estimate> estimates;
  for (const std::string& name : experiment_names()) {
    for (int joint = 0; joint < kJoints; ++joint) {
      estimates.push_back(identify_quietly(name, noisy_log(name, joint), joint));
    }
  }
  const Parameters known = load_parameters(kRobot);
  return format_identification_report(estimates, changes(known, combine(known, estimates)));
}

TEST(Report, RedrawsThePapersFiguresWithResiduals) {
  const std::string html = full_report();
  for (int figure : {3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14}) {
    EXPECT_THAT(html, HasSubstr("<figcaption><span>Fig. " + std::to_string(figure) + ": "));
  }
  EXPECT_EQ(count_of("<figcaption><span>Residuals of Fig", html), 10U);
  EXPECT_EQ(count_of("<canvas id='chart", html), count_of("\"x_label\":", html));  // each has its data
  for (const char* part : {"#e377c2", "#2ca02c", "#d62728", "#111111",             // the paper's branches
                           "\"logarithmic_x\":true", "ln q peak", "envelope", "h is not determined", "h &lt; -",
                           "What two logs say", "viscous, joint 1", "Against the robot known before"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST(Report, NeedsNothingButItself) {
  std::string html = full_report();
  const std::size_t library = html.find(kChartJs);
  ASSERT_NE(library, std::string::npos);
  EXPECT_THAT(kChartJs, HasSubstr("Chart.js v"));
  for (const char* part : {"import(", "fetch(", "XMLHttpRequest", "</script"}) {
    EXPECT_THAT(kChartJs, testing::Not(HasSubstr(part)));
  }
  html.erase(library, std::string(kChartJs).size());
  for (const char* part : {"http", "src=", "href=", "url(", "@import", "<link", "NaN", "Infinity"}) {
    EXPECT_THAT(html, testing::Not(HasSubstr(part)));
  }
}

TEST(ChartPage, TextsCannotBreakThePage) {
  ChartPage page("<b>");
  page.add_paragraph("</script><script>alert(1)</script>");
  page.add_charts({{"\"><img>", "</script>", "y", {{"\xff", "red", Style::kLine, {1, NAN}, {2, 3}}}}});
  page.add_data("texts", R"(["</script><img>"])");
  const std::string html = page.html();
  EXPECT_EQ(count_of("</script>", html), 3U);  // the library's, the page's own, and the data's
  EXPECT_EQ(count_of("<img", html) + count_of("<b>", html), 0U);
  EXPECT_THAT(html, HasSubstr(R"({"x":null,"y":null})"));
}

TEST_F(RobotFile, KeepsWhatNoLogTells) {
  const std::vector<Estimate> one = {identify_quietly("stiffness", noisy_log("stiffness", 0), 0)};
  const Identified found = combine(load_parameters(kRobot), one);
  EXPECT_EQ(found.names, std::vector<std::string>{"spring.stiffness[0]"});
  const Parameters p = load_parameters(write(format_robot(found, kRobot, false)));
  EXPECT_EQ(p.spring.stiffness[1], 17.75);
  EXPECT_EQ(p.link.inertia[0], 0.0915);
  EXPECT_NE(p.spring.stiffness[0], 20.48);
}

}  // namespace
}  // namespace fjr
