// The virtual rig against what theory says of each experiment, and its instruments.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "common/input_error.h"
#include "common/normal.h"
#include "model/encoder.h"
#include "model/rig/experiments.h"
#include "model/rig/rig_file.h"

namespace fjr {
namespace {

Parameters robot() { return load_parameters(FJR_SOURCE_DIR "/config/robot.yaml"); }

// Index of the last row of every period of a staircase.
std::vector<std::size_t> rests(const Staircase& stairs, const Record& record) {
  std::vector<std::size_t> rows;
  const auto period = static_cast<std::size_t>(stairs.period * stairs.sample_rate);
  for (std::size_t row = period - 1; row < record.time.size(); row += period) rows.push_back(row);
  return rows;
}

TEST(Rig, IdealStiffnessStaircaseIsHookesLaw) {
  const Rig rig = Rig::ideal(robot());
  const Staircase stairs = Staircase::of_stiffness(0);
  const Record record = perform_stiffness(rig, 0, stairs);
  const auto rows = rests(stairs, record);
  ASSERT_EQ(rows.size(), 4U * 82);
  for (const std::size_t row : rows) {
    EXPECT_NEAR(record.torques[row][0], rig.truth.spring.stiffness[0] * record.states[row].theta[0], 1e-12);
  }
  EXPECT_NEAR(record.states[rows[81]].theta[0], 0.3864, 1e-4);  // the paper's
  EXPECT_NEAR(record.states[rows[327]].theta[0], 0, 1e-12);
}

TEST(Rig, HysteresisOpensTheLoopByTwiceItsHeight) {
  const Rig rig = Rig::of(robot());
  const Staircase stairs = Staircase::of_stiffness(0);
  const Record record = perform_stiffness(rig, 0, stairs);
  const auto rows = rests(stairs, record);
  EXPECT_NEAR(record.torques[rows[40]][0] - record.torques[rows[122]][0], 2 * rig.hysteresis.height[0], 1e-6);
  EXPECT_NEAR(record.states[rows[40]].theta[0], record.states[rows[122]].theta[0], 1e-12);
}

TEST(Rig, ArmHangsFromItsSpringInEquilibrium) {
  for (const Rig& rig : {Rig::ideal(robot()), Rig::of(robot())}) {
    Staircase stairs{4, 0.3};
    stairs.period = 40;
    const Record record = perform_gravity(rig, 0, stairs);
    for (const std::size_t row : rests(stairs, record)) {
      EXPECT_NEAR(record.torques[row][0], 6.70 * std::sin(record.states[row].q[0]), 1e-4);
    }
  }
}

TEST(Rig, IdealLinkSwingsAsADampedOscillator) {
  const Rig rig = Rig::ideal(robot());
  const Record record = perform_link_inertia(rig, 1, {0.2, 3});
  const double inertia = mass_matrix(rig.truth, 0.0).m22, half = rig.truth.link.damping[1] / (2 * inertia);
  const double omega = std::sqrt(rig.truth.spring.stiffness[1] / inertia - half * half);
  const std::size_t first = 300, second = 2900;
  const auto& a = record.states[first];
  const double t = record.time[second] - record.time[first];
  const double expected =
      std::exp(-half * t) * (a.q[1] * std::cos(omega * t) + (a.dq[1] + half * a.q[1]) / omega * std::sin(omega * t));
  EXPECT_NEAR(record.states[second].q[1], expected, 1e-5);
  EXPECT_EQ(record.states[second].q[0], 0);
}

TEST(Rig, CompensatedMotorAnswersAsAFirstOrderElement) {  // (27)
  const Rig rig = Rig::ideal(robot());
  for (int joint = 0; joint < kJoints; ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    const double b = rig.truth.friction.viscous[j], inertia = rig.truth.motor.inertia[j];
    const Record record = perform_motor_inertia(rig, joint, {{2.0}, 0.1, 0.1});
    const double t = 0.05;
    EXPECT_NEAR(record.states[150].dtheta[j], 2.0 / b * (1 - std::exp(-t * b / inertia)), 1e-6);
    EXPECT_LT(record.states[350].dtheta[j], -1);  // the other direction, after standstill
  }
}

TEST(Rig, ConstantSpeedTakesTheFrictionTorque) {
  const Rig rig = Rig::ideal(robot());
  const Record record = perform_motor_friction(rig, 1, {{0.2, 3.0}});
  EXPECT_EQ(record.torques[599][1], FrictionLaw::of(rig.truth, 1).torque(0.2));
  EXPECT_EQ(record.torques[1199][1], FrictionLaw::of(rig.truth, 1).torque(-0.2));
}

TEST(Rig, InstrumentsAddQuantisationAndNoiseOfTheirSize) {
  const Rig rig = Rig::of(robot());
  Staircase stairs{3, 0.01};
  stairs.period = 20;
  const Record record = perform_stiffness(rig, 0, stairs);
  const Log log = measure(record, rig);
  const double count = count_angle(4000);
  double square = 0;
  for (std::size_t row = 0; row < log.rows(); ++row) {
    const double theta = log.column("theta1")[row];
    EXPECT_NEAR(theta / count, std::round(theta / count), 1e-9);
    EXPECT_LE(std::abs(theta - record.states[row].theta[0]), count);
    square += std::pow(log.column("tau1")[row] - record.torques[row][0], 2);
  }
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(log.rows())), 0.05, 0.002);
}

TEST(Rig, LogsAreReproducibleAndReadBack) {
  Rig rig = Rig::of(robot());
  const std::string once = format_log(measure(perform("link_inertia", rig, 1, Experiments::of_paper(false)), rig));
  EXPECT_EQ(once, format_log(measure(perform("link_inertia", rig, 1, Experiments::of_paper(false)), rig)));
  const Log log = parse_log(once, "log.csv");
  EXPECT_EQ(format_log(log), once);
  EXPECT_EQ(log.metadata.at("experiment"), "link_inertia");
  EXPECT_EQ(log.number("joint", 0), 2);
  rig.seed = 2;
  EXPECT_NE(once, format_log(measure(perform("link_inertia", rig, 1, Experiments::of_paper(false)), rig)));
}

TEST(Normal, HasTheMomentsOfTheNormalDistribution) {
  Normal normal(3);
  constexpr int kCount = 100000;
  double sum = 0, square = 0, fourth = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = normal();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.02);
  EXPECT_NEAR(square / kCount, 1, 0.02);
  EXPECT_NEAR(fourth / kCount, 3, 0.15);
}

const std::string kRigFile = FJR_SOURCE_DIR "/config/rig.yaml";

RigSetup setup_from(const std::string& text) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("fjr_rig_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << text;
  RigSetup setup{Rig::of(robot()), Experiments::of_paper(false)};
  try {
    read_rig(file, setup);
  } catch (const InputError& error) {
    std::filesystem::remove(file);
    throw InputError("rig.yaml", error.field(), error.problem());
  }
  std::filesystem::remove(file);
  return setup;
}

// The shipped file names every key with its default: everything that it did not set would stay spoiled.
TEST(RigFile, TheShippedOneHasEveryDefault) {
  const RigSetup defaults{Rig::of(robot()), Experiments::of_paper(false)};
  const Staircase clamped{1, 1, 1, 1, 1, 1}, free{1, 1, 1, 1, 1, 1, false};
  RigSetup setup = defaults;
  setup.rig.hysteresis = {{9, 9}, {9, 9}};
  setup.rig.instruments = {{9, 9}, {9, 9}, false};
  setup.rig.truth.encoder = {{9, 9}, {9, 9}};
  setup.rig.truth.link.damping = {9, 9};
  setup.rig.seed = 9;
  Experiments& e = setup.experiments;
  e = {{clamped, clamped},
       {free, free},
       {Impulse{1, 1, 1, true}, Impulse{1, 1, 1, true}},
       {ConstantSpeeds{{}, 9, 9, 9}, ConstantSpeeds{{}, 9, 9, 9}},
       {ConstantTorques{{}, 9, 9, 9}, ConstantTorques{{}, 9, 9, 9}}};
  read_rig(kRigFile, setup);
  for (std::size_t j = 0; j < kJoints; ++j) e.motor_friction[j].speeds = defaults.experiments.motor_friction[j].speeds;
  EXPECT_EQ(setup.experiments, defaults.experiments);
  EXPECT_EQ(setup.rig.hysteresis, defaults.rig.hysteresis);
  EXPECT_EQ(setup.rig.instruments, defaults.rig.instruments);
  EXPECT_EQ(setup.rig.truth.encoder.motor_counts, defaults.rig.truth.encoder.motor_counts);
  EXPECT_EQ(setup.rig.truth.encoder.link_counts, defaults.rig.truth.encoder.link_counts);
  EXPECT_EQ(setup.rig.truth.link.damping, defaults.rig.truth.link.damping);
  EXPECT_EQ(setup.rig.seed, defaults.rig.seed);
}

std::string rig_error(const std::string& text) {
  try {
    setup_from(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(RigFile, WhatMakesNoExperimentIsRefused) {
  EXPECT_EQ(rig_error("hysteresis: {high: 1}"), "rig.yaml: hysteresis: unknown key \"high\"; allowed: height, width");
  EXPECT_EQ(rig_error("link_damping: [0.1, -1]"),
            "rig.yaml: link_damping: -1 N m s/rad is outside [0, 1000 N m s/rad]");
  EXPECT_EQ(rig_error("stiffness: {steps: 4.5}"), "rig.yaml: stiffness.steps: 4.5 is not a whole number");
  EXPECT_EQ(rig_error("gravity: {period: 2}"), "rig.yaml: gravity: move and average together are longer than period");
  EXPECT_EQ(rig_error("stiffness: {sample_rate: 20000}"),
            "rig.yaml: stiffness: 6.56e+07 rows at 20000 Hz; at most 1e+07");
  EXPECT_EQ(rig_error("link_inertia: {gravity: 1}"), "rig.yaml: link_inertia.gravity: must be true or false");
  EXPECT_EQ(rig_error("motor_friction: {speeds: [[1, 2]]}"),
            "rig.yaml: motor_friction.speeds: must be two lists, of joint 1 and of joint 2");
  EXPECT_EQ(rig_error("motor_inertia: {torques: [[1], [0]]}"),
            "rig.yaml: motor_inertia.torques[1][0]: 0 N m is outside [0.001, 1000 N m]");
}

TEST(RigFile, GravityStiffensThePendulum) {
  const RigSetup lying = setup_from("link_inertia: {amplitude: 0.05, duration: 3}\nhysteresis: {height: 0}");
  const RigSetup hanging =
      setup_from("link_inertia: {amplitude: 0.05, duration: 3, gravity: true}\nhysteresis: {height: 0}");
  const auto period = [](const RigSetup& setup) {
    const Record record = perform("link_inertia", setup.rig, 0, setup.experiments);
    std::vector<double> times;
    for (std::size_t row = 1; row < record.time.size(); ++row) {
      if (record.states[row - 1].q[0] > 0 && record.states[row].q[0] <= 0) times.push_back(record.time[row]);
    }
    return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  };
  const double k = lying.rig.truth.spring.stiffness[0];
  EXPECT_NEAR(period(lying) / period(hanging), std::sqrt((k + 6.70) / k), 0.002);  // small swings: K + S
}

TEST(Rig, LogsOfAnyRateShowTheSameMotion) {
  const RigSetup usual = setup_from("hysteresis: {height: 0.05}\ninstruments: {velocity_noise: 0}");
  const RigSetup slow = setup_from(
      "hysteresis: {height: 0.05}\ninstruments: {velocity_noise: 0}\nlink_inertia: {sample_rate: 40}\n"
      "motor_inertia: {sample_rate: 100}");
  for (const auto& [name, stride] : {std::pair{"link_inertia", std::size_t{25}}, {"motor_inertia", std::size_t{10}}}) {
    const Record fine = perform(name, usual.rig, 1, usual.experiments);
    const Record coarse = perform(name, slow.rig, 1, slow.experiments);
    ASSERT_GT(coarse.time.size(), 100U);
    for (std::size_t row = 0; row < coarse.time.size(); ++row) {
      EXPECT_NEAR(coarse.time[row], fine.time[row * stride], 1e-9);
      EXPECT_NEAR(coarse.states[row].q[1], fine.states[row * stride].q[1], 1e-6) << name;
      EXPECT_NEAR(coarse.states[row].dtheta[1], fine.states[row * stride].dtheta[1], 1e-6) << name;
    }
  }
}

const std::string kHeader = "time,q1,q2,theta1,theta2,tau1,tau2\n";

std::string error_of(const std::string& text, const ColumnNames& renamed = {}) {
  try {
    parse_log(text, "log.csv", renamed);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Log, ErrorsNameLineAndColumn) {
  EXPECT_EQ(error_of(""), "log.csv: no header: expected a line 'time,q1,q2,theta1,theta2,tau1,tau2'");
  EXPECT_EQ(error_of(kHeader + "0,0,0,0,0,0,0\n"), "log.csv: 1 rows; a log has at least 2");
  EXPECT_EQ(error_of("time,q1\n"), "log.csv: line 1: column q2 is missing in 'time,q1'");
  EXPECT_EQ(error_of("# a: 1\n" + kHeader + "0,0,0,x,0,0,0\n"), "log.csv: line 3, column theta1: 'x' is not a number");
  EXPECT_EQ(error_of(kHeader + "0,0,0,0,0,0,nan\n"), "log.csv: line 2, column tau2: 'nan' is not finite");
  EXPECT_EQ(error_of(kHeader + "0,0,0,0,0,0\n"), "log.csv: line 2: 6 fields where the header has 7 columns");
  EXPECT_EQ(error_of(kHeader + "1,0,0,0,0,0,0\n1,0,0,0,0,0,0\n"),
            "log.csv: line 3, column time: 1 does not come after 1 of the row before");
  EXPECT_EQ(error_of(kHeader, {{"dtheta1", "speed"}}),
            "log.csv: line 1: no column 'speed', which was said to be dtheta1");
}

TEST(Log, ColumnsMayHaveOtherNames) {
  const Log log =
      parse_log("t,q1,q2,theta1,theta2,tau1,tau2\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n", "log.csv", {{"time", "t"}});
  EXPECT_EQ(log.column("time"), (std::vector<double>{0, 1}));
}

TEST(Log, TheColumnThatWasNamedIsTakenAndNoOther) {
  const std::string text = "time,q1,q2,theta1,theta2,tau1,tau2,q1_rad\n0,57,2,3,4,5,6,1\n1,57,2,3,4,5,6,1\n";
  EXPECT_EQ(parse_log(text, "log.csv", {{"q1", "q1_rad"}}).column("q1"), (std::vector<double>{1, 1}));
  EXPECT_EQ(error_of(text, {{"q1", "q1_deg"}}), "log.csv: line 1: no column 'q1_deg', which was said to be q1");
}

// What the executor writes, and other recorders: commanded values and columns of their own.
TEST(Log, CommandedValuesAreReadAndOtherColumnsIgnored) {
  const Log log = parse_log(
      "# robot_hash: ab\n# request_id: 7\n"
      "time,q1,q2,theta1,theta2,tau1,tau2,dtheta1,dtheta2,q1_plan,tau1_plan,phase\n"
      "0,1,2,3,4,5,6,7,8,9,10,hold\n0.001,1,2,3,4,5,6,7,8,9,10,\n",
      "log.csv");
  EXPECT_EQ(log.metadata.at("request_id"), "7");
  EXPECT_EQ(log.column("dtheta2")[0], 8);
  EXPECT_EQ(log.column("q1_plan")[1], 9);
  EXPECT_EQ(log.column("tau1_plan")[1], 10);
  EXPECT_FALSE(log.has("phase"));
}

}  // namespace
}  // namespace fjr
