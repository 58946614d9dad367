// The shipped robot.yaml, its hash, and everything the loader must refuse.
#include "model/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "common/sha256.h"
#include "common/strict_yaml.h"
#include "model/plausibility.h"
#include "model/uncertainty.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;

const fs::path kShipped = fs::path(FJR_SOURCE_DIR) / "config/robot.yaml";

// A folder of this test's own, gone with it.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "fjr_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  fs::path path_;
};

std::string shipped_text() {
  std::ifstream in(kShipped, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "not in robot.yaml: " << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// "field: problem" of the error that loading `text` ends in.
std::string error_of(const std::string& text) {
  const Folder folder;
  const fs::path file = folder.write("robot.yaml", text);
  try {
    load_parameters(file);
  } catch (const InputError& e) {
    EXPECT_EQ(e.source(), file.string());
    return (e.field().empty() ? "" : e.field() + ": ") + e.problem();
  }
  return "no error";
}

std::string error_after(const std::string& from, const std::string& to) {
  return error_of(replaced(shipped_text(), from, to));
}

TEST(Sha256, GivesThePublishedTestVectors) {  // FIPS 180-2, appendix B
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Parameters, ShippedRobotHasThePapersConstants) {
  const Parameters p = load_parameters(kShipped);
  using P = Joints<double>;
  EXPECT_EQ(p.link.length, (P{0.345, 0.305}));
  EXPECT_EQ(p.link.mass, (P{1.570, 0.660}));
  EXPECT_EQ(p.link.com_fraction, (P{0.7420, 0.2687}));
  EXPECT_EQ(p.link.inertia, (P{0.0915, 7.1672e-3}));
  EXPECT_EQ(p.link.gravity_torque, (P{6.17, 0.53}));
  EXPECT_EQ(p.spring.stiffness, (P{20.48, 17.75}));
  EXPECT_EQ(p.motor.inertia, (P{0.0686, 0.0145}));
  EXPECT_EQ(p.friction.viscous, (P{0.4968, 0.5051}));
  EXPECT_EQ(p.friction.amplitude, (P{1.123, 0.8607}));
  EXPECT_EQ(p.friction.width, (P{0.9505, 0.0174}));
  EXPECT_EQ(p.friction.second_weight, (P{-0.7154, -0.1019}));
  EXPECT_EQ(p.friction.second_shape, (P{-6539.2, 11.9636}));
  EXPECT_EQ(p.encoder.motor_counts, (P{4000, 2000}));
  EXPECT_EQ(p.encoder.link_counts, (P{65536, 65536}));
  EXPECT_EQ(p.limits.spring_deflection, (P{0.3864, 0.2262}));
}

TEST(Parameters, ShippedRobotHasTheAssumptionsOfTheDesign) {
  const Parameters p = load_parameters(kShipped);
  using P = Joints<double>;
  EXPECT_EQ(p.link.damping, (P{0, 0}));
  EXPECT_EQ(p.link.radius, (P{0.03, 0.025}));
  EXPECT_EQ(p.limits.torque, (P{12, 5}));
  EXPECT_EQ(p.limits.motor_velocity, (P{6, 8}));
  EXPECT_EQ(p.limits.link_position, (P{3.2, 2.6}));
  EXPECT_EQ(p.feedback.position_gain, (P{50, 20}));
  EXPECT_EQ(p.feedback.velocity_gain, (P{2, 0.5}));
  EXPECT_EQ(p.feedback.velocity_filter, (P{30, 30}));
  EXPECT_EQ(p.drive.peak_torque, (P{14.4, 6}));
}

// The paper's own relations (7), (16) and (18), with the g = 9.8 m/s^2 that its printed alphas follow from.
TEST(Parameters, ShippedConstantsAgreeWithEachOther) {
  const Parameters p = load_parameters(kShipped);
  const double l1 = p.link.length[0], m2 = p.link.mass[1], r2 = p.link.com_fraction[1] * p.link.length[1];
  EXPECT_NEAR(m2 * 9.8 * r2, p.link.gravity_torque[1], 1e-3);
  EXPECT_NEAR((p.link.com_fraction[0] * p.link.mass[0] + m2) * 9.8 * l1, p.link.gravity_torque[0], 2e-2);
  EXPECT_NEAR(p.link.inertia[1] + m2 * r2 * r2, 0.0116, 1e-4);
  EXPECT_NEAR(p.link.inertia[0] + 0.0116 + m2 * l1 * l1 + 2 * m2 * l1 * r2, 0.2190, 1e-4);
}

TEST(Parameters, EveryShippedValueSaysWhereItIsFrom) {
  const YamlNode root = YamlNode::load(kShipped);
  Parameters p;
  visit_parameters(p, [&](const char* section, const char* name, const char*, Joints<double>&) {
    const std::string source = root.at(section).at(name).at("source").text();
    EXPECT_TRUE(source.starts_with("paper ") || source.starts_with("assumption: ")) << section << "." << name;
  });
}

TEST(Parameters, StandardErrorsAndCovarianceAreAccepted) {
  const Folder folder;
  std::string text = replaced(shipped_text(), "section IV-A, the spring of eq. (1)\", standard_error: null",
                              "measured\", standard_error: [0.05, 0]");
  text +=
      "covariance: {names: [\"spring.stiffness[0]\", \"motor.inertia[1]\"], matrix: [[4e-2, 1e-3], [1e-3, 1e-4]]}\n";
  const Parameters p = load_parameters(folder.write("robot.yaml", text));
  EXPECT_EQ(robot_hash(p), robot_hash(load_parameters(kShipped)));  // statistics are not part of the robot
}

Uncertainty uncertainty_in(const std::string& text) {
  const Folder folder;
  return uncertainty_of(load_parameters(folder.write("robot.yaml", text)));
}

TEST(Parameters, UncertaintyIsWhatCovarianceAndStandardErrorsSay) {
  EXPECT_TRUE(uncertainty_in(shipped_text()).none());
  std::string text = replaced(shipped_text(), "section IV-A, the spring of eq. (1)\", standard_error: null",
                              "measured\", standard_error: [0.05, 0.07]");
  text +=
      "covariance:\n"
      "  - {names: [\"spring.stiffness[0]\", \"motor.inertia[1]\"], matrix: [[4e-2, 1e-5], [1e-5, 1e-8]]}\n"
      "  - {names: [\"friction.viscous[0]\"], matrix: [[9e-6]]}\n"
      "payload: {mass: {value: 0.2, unit: kg, standard_error: 0.01}}\n";
  const Uncertainty u = uncertainty_in(text);
  EXPECT_EQ(u.names, (std::vector<std::string>{"spring.stiffness[0]", "spring.stiffness[1]", "motor.inertia[1]",
                                               "friction.viscous[0]", "payload.mass"}));
  EXPECT_DOUBLE_EQ(u.standard_error(0), 0.2);  // of the block, not of the entry
  EXPECT_DOUBLE_EQ(u.standard_error(1), 0.07);
  EXPECT_DOUBLE_EQ(u.covariance(0, 2), 1e-5);
  EXPECT_DOUBLE_EQ(u.covariance(0, 1), 0);
  EXPECT_DOUBLE_EQ(u.standard_error(4), 0.01);
  const Eigen::MatrixXd factor = u.factor();
  EXPECT_TRUE((factor * factor.transpose()).isApprox(u.covariance, 1e-12));
}

// What is told by the same measurement is no direction of its own.
TEST(Parameters, ASingularCovarianceHasFewerDirections) {
  const Uncertainty u = uncertainty_in(shipped_text() +
                                       "covariance: {names: [\"link.gravity_torque[1]\", \"link.com_fraction[1]\"], "
                                       "matrix: [[4e-8, 2e-8], [2e-8, 1e-8]]}");
  EXPECT_EQ(u.factor().cols(), 1);
  EXPECT_TRUE((u.factor() * u.factor().transpose()).isApprox(u.covariance, 1e-9));
}

// I about the joint is I about the centre of mass and m (alpha l)^2: with m = 0.66, alpha = 0.2687, l = 0.305 an error
// of alpha of 0.01 takes 2 m alpha l^2 0.01 = 3.30e-4 from the other.
TEST(Parameters, ErrorsOfInertiasMoveWithTheirPoints) {
  std::string text = replaced(shipped_text(), "[0.0915, 7.1672e-3], about: [joint, center_of_mass]",
                              "[0.0915, 1.16e-2], about: [joint, joint]");
  text += "covariance: {names: [\"link.com_fraction[1]\", \"link.inertia[1]\"], matrix: [[1e-4, 0], [0, 1e-20]]}";
  const Uncertainty u = uncertainty_in(text);
  ASSERT_EQ(u.names.size(), 2U);
  EXPECT_NEAR(u.standard_error(1), 2 * 0.66 * 0.2687 * 0.305 * 0.305 * 0.01, 1e-8);
  EXPECT_LT(u.covariance(0, 1), 0);
}

TEST(Parameters, StandardErrorMayBeKnownForOneJointAlone) {
  const auto with = [](const std::string& errors) {
    return error_after("source: \"paper eq. (8)\", standard_error: null",
                       "source: \"measured\", standard_error: " + errors);
  };
  EXPECT_EQ(with("[null, 0.01]"), "no error");
  EXPECT_EQ(with("[null, -0.01]"), "link.gravity_torque.standard_error[1]: -0.01 N m must be >= 0");
  EXPECT_EQ(with("[null]"),
            "link.gravity_torque.standard_error: must be two numbers (N m), [joint 1, joint 2], not a list of 1");
}

TEST(Parameters, BrokenEntriesAreRefusedByName) {
  EXPECT_EQ(error_after("[20.48, 17.75]", "[20.48, -17.75]"), "spring.stiffness.value[1]: -17.75 N m/rad must be > 0");
  EXPECT_EQ(error_after("[20.48, 17.75]", "[0, 17.75]"), "spring.stiffness.value[0]: 0 N m/rad must be > 0");
  EXPECT_EQ(error_after("[0.7420, 0.2687]", "[1.742, 0.2687]"),
            "link.com_fraction.value[0]: 1.742 must be from 0 to 1");
  EXPECT_EQ(error_after("[0.4968, 0.5051]", "[-0.4968, 0.5051]"),
            "friction.viscous.value[0]: -0.4968 N m s/rad must be >= 0");
  EXPECT_EQ(error_after("[0.9505, 0.0174]", "[0.9505, 0]"), "friction.width.value[1]: 0 rad/s must be > 0");
  EXPECT_EQ(error_after("[1.123, 0.8607]", "[1.123, -1]"), "friction.amplitude.value[1]: -1 N m must be >= 0");
  EXPECT_EQ(error_after("[4000, 2000]", "[4000.5, 2000]"),
            "encoder.motor_counts.value[0]: 4000.5 1/rev must be a whole number from 1 to 1000000000");
  EXPECT_EQ(error_after("[6.17, 0.53]", "[6.17, .nan]"),
            "link.gravity_torque.value[1]: \".nan\" is not a finite number (N m)");
  EXPECT_EQ(error_after("[6.17, 0.53]", "[6.17, inf]"),
            "link.gravity_torque.value[1]: \"inf\" is not a finite number (N m)");
  EXPECT_EQ(error_after("[6.17, 0.53]", "[6.17, 1e999]"), "link.gravity_torque.value[1]: \"1e999\" is out of range");
  EXPECT_EQ(error_after("[6.17, 0.53]", "[6.17, \"0.53\"]"),
            "link.gravity_torque.value[1]: must be a number (N m), not the text \"0.53\"");
  EXPECT_EQ(error_after("[6.17, 0.53]", "[6.17, 0x1p3]"),
            "link.gravity_torque.value[1]: \"0x1p3\" is not a finite number (N m)");
  EXPECT_EQ(error_after("[6.17, 0.53]", "[6.17]"),
            "link.gravity_torque.value: must be two numbers (N m), [joint 1, joint 2], not a list of 1");
  EXPECT_EQ(error_after("[0.0686, 0.0145]", "0.0686"),
            "motor.inertia.value: must be two numbers (kg m^2), [joint 1, joint 2], not the number 0.0686");
}

TEST(Parameters, WrongShapesOfTheFileAreRefused) {
  EXPECT_EQ(error_after("unit: \"kg\"", "unit: \"g\""), "link.mass.unit: \"g\" must be \"kg\"");
  EXPECT_EQ(error_after("unit: \"kg\"", "unit: 1"), "link.mass.unit: \"1\" must be \"kg\"");
  EXPECT_EQ(error_after("unit: \"kg\", ", ""), "link.mass.unit: missing");
  EXPECT_EQ(error_after("source: \"paper eq. (8)\"", "source: \"\""), "link.gravity_torque.source: must not be empty");
  EXPECT_EQ(error_after("source: \"paper eq. (8)\", standard_error: null", "source: \"paper eq. (8)\""),
            "link.gravity_torque.standard_error: missing");
  EXPECT_EQ(error_after("source: \"paper eq. (8)\", standard_error: null",
                        "source: \"paper eq. (8)\", standard_error: [1, -2]"),
            "link.gravity_torque.standard_error[1]: -2 N m must be >= 0");
  EXPECT_EQ(error_after("{value: [6.17, 0.53]", "{sigma: 1, value: [6.17, 0.53]"),
            "link.gravity_torque: unknown key \"sigma\"; allowed: value, unit, source, standard_error");
  EXPECT_EQ(error_after("  stiffness:", "  stifness:"),
            "spring: unknown key \"stifness\"; allowed: stiffness; did you mean stiffness?");
  EXPECT_EQ(error_after("motor:\n", "engine:\n"),
            "unknown key \"engine\"; allowed: link, spring, motor, friction, encoder, limits, feedback, drive, "
            "covariance, payload, mounting");
  EXPECT_EQ(error_after("motor:\n  inertia", "# inertia"), "motor: missing");
  EXPECT_EQ(error_after("{value: [6.17", "{value: [1, 2], value: [6.17"), "line 13: key \"value\" is given twice");
  EXPECT_EQ(error_of(""), "empty");
  EXPECT_EQ(error_of("- 1\n"),
            "must be a map with the keys link, spring, motor, friction, encoder, limits, feedback, drive, covariance, "
            "payload, mounting, not a list of 1");
  EXPECT_EQ(error_of(shipped_text() + "---\na: 1\n"), "holds more than one YAML document");
  EXPECT_EQ(error_of(std::string(kMaxYamlBytes + 1, ' ')), "larger than 1048576 bytes");
}

TEST(Parameters, UnphysicalCombinationsAreRefused) {
  EXPECT_EQ(error_after("[14.4, 6]", "[11, 6]"), "drive.peak_torque.value[0]: 11 N m must be >= limits.torque, 12 N m");
  EXPECT_EQ(error_after("[0.3864, 0.2262]", "[0.32, 0.2262]"),
            "limits.spring_deflection.value[0]: 0.32 rad is less than the 0.327148 rad by which gravity deflects this "
            "spring at rest");
  EXPECT_EQ(error_after("[1.570, 0.660]", "[1.570, 1e300]"),
            "link: the mass matrix is not positive definite at q2 = 0 rad");
}

// The first "field: problem" of what is doubted in the shipped robot with a part of its text replaced.
std::string doubt_after(const std::string& from, const std::string& to) {
  const Folder folder;
  const auto doubts = doubts_about(load_parameters(folder.write("robot.yaml", replaced(shipped_text(), from, to))));
  return doubts.empty() ? "" : doubts.front().text();
}

TEST(Parameters, WhatNoArmCanHaveIsRefused) {
  EXPECT_EQ(error_after("[0.0915, 7.1672e-3]", "[0.001, 7.1672e-3]"),
            "link.inertia.value[0]: 0.001 kg m^2 about the joint is 0.00972 of the 0.1029 kg m^2 that 1.57 kg with the "
            "centre of mass 0.256 m from the joint (com_fraction times length) have at least");
  EXPECT_EQ(
      error_after("[0.0915, 7.1672e-3]", "[0.0915, 71.672]"),
      "link.inertia.value[1]: 71.67 kg m^2 about the centre of mass is 4e+03 times the most that 0.66 kg within a "
      "link of 0.305 m can have, 0.01792 kg m^2");
  EXPECT_EQ(
      error_after("[6.17, 0.53]", "[6.17, 1.06]"),
      "link.gravity_torque.value[1]: 1.06 N m does not go with joint 1's 6.17 N m: masses, lengths and centres of "
      "mass then give 0.5301 N m");
  EXPECT_EQ(
      error_after("[1.570, 0.660]", "[0.9, 0.660]"),
      "link.gravity_torque.value[0]: 6.17 N m is 1.37 times the 4.489 N m that masses, lengths and centres of mass "
      "give");
  EXPECT_THAT(error_after("[-0.7154, -0.1019]", "[-0.7154, 1.5]"),
              HasSubstr("friction.amplitude.value[1]: this law drives the motor by "));
}

TEST(Parameters, WhatIsImprobableIsDoubtedByName) {
  EXPECT_TRUE(doubts_about(load_parameters(kShipped)).empty());
  EXPECT_THAT(doubt_after("[0.0915, 7.1672e-3]", "[0.08, 7.1672e-3]"), HasSubstr("link.inertia.value[0]: 0.08 kg m^2"));
  EXPECT_THAT(doubt_after("[0.0915, 7.1672e-3]", "[0.0915, 1e-6]"), HasSubstr("link.inertia.value[1]: 1e-06 kg m^2"));
  EXPECT_THAT(doubt_after("[6.17, 0.53]", "[3.085, 0.265]"), HasSubstr("inclined by 30 degrees"));
  EXPECT_EQ(doubt_after("[6.17, 0.53]", "[0, 0]"), "");  // flat on a table
  EXPECT_THAT(doubt_after("[6.17, 0.53]", "[6.17, 0.6]"), HasSubstr("link.gravity_torque.value[1]: 0.6 N m"));
  EXPECT_THAT(doubt_after("[65536, 65536]", "[65536, 100]"),
              HasSubstr("encoder.link_counts.value[1]: a count is 0.0628 rad"));
  EXPECT_THAT(doubt_after("[0.03, 0.025]", "[0.3, 0.025]"), HasSubstr("link.radius.value[0]: 0.3 m"));
  EXPECT_THAT(doubt_after("[20.48, 17.75]", "[20.48, 1e6]"), HasSubstr("spring.stiffness.value[1]: 1e+06 N m/rad"));
}

// Where an inertia is about is said, and changes nothing but the numbers that stand there.
TEST(Parameters, InertiasMayBeAboutEitherPoint) {
  const Parameters shipped = load_parameters(kShipped);
  const Folder folder;
  const auto with = [&](const std::string& inertia) {
    const std::string text = replaced(shipped_text(), "[0.0915, 7.1672e-3], about: [joint, center_of_mass]", inertia);
    return load_parameters(folder.write("robot.yaml", text));
  };
  EXPECT_EQ(robot_hash(with("[0.0915, 7.1672e-3]")), robot_hash(shipped));
  // I2 of (16), and a link 1 with a centre of mass: parallel axes.
  const Parameters other = with("[0.01, 0.0116], about: [center_of_mass, joint]");
  const double r1 = 0.7420 * 0.345, r2 = 0.2687 * 0.305;
  EXPECT_DOUBLE_EQ(other.link.inertia[0], 0.01 + 1.570 * r1 * r1);
  EXPECT_DOUBLE_EQ(other.link.inertia[1], 0.0116 - 0.660 * r2 * r2);
  EXPECT_EQ(error_after("center_of_mass]", "middle]"),
            "link.inertia.about[1]: \"middle\" is not one of joint, center_of_mass");
  EXPECT_EQ(error_after("[joint, center_of_mass]", "[joint]"),
            "link.inertia.about: must be two points, [joint 1, joint 2]");
  EXPECT_EQ(error_after("[0.0915, 7.1672e-3], about: [joint, center_of_mass]", "[0.0915, 4e-3], about: [joint, joint]"),
            "link.inertia.value[1]: 0.004 kg m^2 about the joint must be > 0.00443281 kg m^2, which 0.66 kg with the "
            "centre of mass 0.0819535 m from the joint have at least");
  EXPECT_THAT(error_after("{value: [0.345, 0.305]", "{about: [joint, joint], value: [0.345, 0.305]"),
              HasSubstr("link.length: unknown key \"about\""));
}

TEST(Parameters, BrokenCovariancesAreRefused) {
  const auto with = [](const std::string& covariance) {
    return error_of(shipped_text() + "covariance: " + covariance);
  };
  EXPECT_EQ(with("{names: [spring.stiffness], matrix: [[1]]}"),
            "covariance.names[0]: \"spring.stiffness\" is not a parameter; parameters are written like "
            "\"spring.stiffness[0]\"");
  EXPECT_EQ(with("{names: [\"motor.inertia[0]\", \"motor.inertia[0]\"], matrix: [[1, 0], [0, 1]]}"),
            "covariance.names[1]: \"motor.inertia[0]\" is given twice");
  EXPECT_EQ(with("{names: [\"motor.inertia[0]\"], matrix: [[1], [2]]}"),
            "covariance.matrix: has 2 rows, but covariance.names has 1");
  EXPECT_EQ(with("{names: [\"motor.inertia[0]\"], matrix: [[1, 2]]}"),
            "covariance.matrix[0]: has 2 values, but covariance.names has 1");
  EXPECT_EQ(with("{names: [\"motor.inertia[0]\"], matrix: [[-1]]}"),
            "covariance.matrix[0][0]: a variance of -1 must be >= 0");
  EXPECT_EQ(with("{names: [\"motor.inertia[0]\", \"motor.inertia[1]\"], matrix: [[1, 0.5], [0.25, 1]]}"),
            "covariance.matrix[1][0]: 0.25 must equal matrix[0][1], 0.5");
  EXPECT_EQ(with("{names: [\"motor.inertia[0]\"], matrix: [[.inf]]}"),
            "covariance.matrix[0][0]: \".inf\" is not a finite number");
  EXPECT_EQ(with("{names: [\"motor.inertia[0]\"]}"), "covariance.matrix: missing");
  EXPECT_EQ(with("[{names: [\"motor.inertia[0]\"], matrix: [[1]]}, {names: [\"motor.inertia[0]\"], matrix: [[1]]}]"),
            "covariance[1].names[0]: \"motor.inertia[0]\" is given twice");
  EXPECT_EQ(with("{names: [\"motor.inertia[0]\", \"motor.inertia[1]\"], matrix: [[1, 2], [2, 1]]}"),
            "covariance.matrix: is no covariance: a combination of its parameters would have a negative variance");
}

TEST(Parameters, YamlThatNoConfigurationNeedsIsRefused) {
  EXPECT_EQ(error_of("link: &a [1]\n"), "line 1: anchors (&name) are not allowed");
  EXPECT_EQ(error_of("link: !!float 1\n"), "line 1: tags (!name) are not allowed");
  EXPECT_EQ(error_of("? [1]\n: 2\n"), "line 1: a key must be text");
  EXPECT_EQ(error_of("link:\n  " + std::string(100, '[') + std::string(100, ']')),
            "line 2: nested deeper than 16 levels");
  EXPECT_THAT(error_of("link: [1\nspring: ]\n"), HasSubstr("line 2"));
  std::string many = "link: [";
  for (int i = 0; i < 30000; ++i) many += "1,";
  EXPECT_EQ(error_of(many + "1]\n"), "line 1: more than 20000 values");
}

TEST(Parameters, MessagesNameTheFileAsGivenAndStayPrintable) {
  const Folder folder;
  const fs::path missing = folder.path() / "none.yaml";
  try {
    load_parameters(missing);
    FAIL() << "a file that does not exist was read";
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()), missing.string() + ": no such file");
  }
  EXPECT_THROW(load_parameters(folder.path()), InputError);
  EXPECT_THROW(load_parameters("/dev/zero"), InputError);  // would never end
  EXPECT_EQ(shown("a\x1b[2J\"\n"), "\"a\\x1b[2J\\x22\\x0a\"");
  EXPECT_EQ(shown(std::string(100, 'x')), "\"" + std::string(40, 'x') + "...\"");
}

// The digests were computed by another program from the text that the header promises.
TEST(RobotHash, IsTheShaOfSortedNamesAndValues) {
  Parameters p{};
  EXPECT_EQ(robot_hash(p), "897f70a47a7da44346f1bb7f90f9e12ae35425f8612820e2d5ce2392906b6438");
  int n = 0;
  visit_parameters(p, [&](const char*, const char*, const char*, Joints<double>& value) {
    value = {n + 0.1, n + 0.2};
    ++n;
  });
  EXPECT_EQ(robot_hash(p), "fca958d8de0486e0e7075e88fdb26a22e2777aa3b23a1038c9d14ef9c78cad3d");
  p.payload = {0.3, 0.001};
  EXPECT_EQ(robot_hash(p), "3c34fca42ef791889b97bd448510cc856dbb436c6d88978599e165a026b1b3a6");
}

TEST(RobotHash, DependsOnEveryValueAndOnNothingElse) {
  const Parameters shipped = load_parameters(kShipped);
  Parameters changed = shipped;
  visit_parameters(changed, [&](const char* section, const char* name, const char*, Joints<double>& value) {
    for (double& v : value) {
      const double before = v;
      v = std::nextafter(v, 1e9);
      EXPECT_NE(robot_hash(changed), robot_hash(shipped)) << section << "." << name;
      v = before;
    }
  });
  const Folder folder;
  const std::string reformatted = replaced("# another comment\n" + shipped_text(), "[12, 5]", "[ 12.0,   5e0 ]");
  EXPECT_EQ(robot_hash(load_parameters(folder.write("other.yaml", reformatted))), robot_hash(shipped));
}

TEST(RobotHash, IsThatOfBeforeWhereTheNewerEntriesAreLeftOut) {
  const Folder folder;
  std::string text = shipped_text();
  const auto begin = text.find("  copper_loss:");
  text.erase(begin, text.find('\n', begin) + 1 - begin);
  const Parameters without = load_parameters(folder.write("robot.yaml", text));
  EXPECT_EQ(without.drive.copper_loss, load_parameters(kShipped).drive.copper_loss);
  // As it was before there were copper losses and payloads.
  EXPECT_EQ(robot_hash(without), "bf107b1196c38710ea4da3abbe26e8770c7e32928b55aca7bfd1bd3a7d714b96");
  EXPECT_EQ(robot_hash(load_parameters(kShipped)), robot_hash(without));
  EXPECT_EQ(robot_hash(load_parameters(folder.write("none.yaml", text + "payload: 0\n"))), robot_hash(without));
  const auto middle = text.find("  link_middle:");
  text.erase(middle, text.find('\n', middle) + 1 - middle);
  EXPECT_EQ(robot_hash(load_parameters(folder.write("middle.yaml", text))), robot_hash(without));
}

TEST(Parameters, APayloadIsAMassOrAMassAndAnInertia) {
  const Folder folder;
  const auto payload = [&](const std::string& entry) {
    return load_parameters(folder.write("robot.yaml", shipped_text() + "payload: " + entry + "\n")).payload;
  };
  EXPECT_EQ(load_parameters(kShipped).payload, (Payload{0, 0}));
  EXPECT_EQ(payload("0.3"), (Payload{0.3, 0}));
  EXPECT_EQ(payload("{mass: 0.3, inertia: 1e-3}"), (Payload{0.3, 1e-3}));
  EXPECT_EQ(payload("{value: 0.3, unit: kg, source: scales}"), (Payload{0.3, 0}));
  EXPECT_EQ(payload("{mass: {value: 0.3, unit: kg, source: scales, standard_error: 0.001}}"), (Payload{0.3, 0}));
  const auto error = [&](const std::string& entry) { return error_of(shipped_text() + "payload: " + entry + "\n"); };
  EXPECT_EQ(error("-0.1"), "payload: -0.1 kg is outside [0, 10]");
  EXPECT_EQ(error("{mass: 11}"), "payload.mass: 11 kg is outside [0, 10]");
  EXPECT_EQ(error("{inertia: 1}"), "payload.mass: missing");
  EXPECT_EQ(error("{mass: 1, inertia: 2}"), "payload.inertia: 2 kg m^2 is outside [0, 1]");
  EXPECT_EQ(error("{mass: {value: 1, unit: g}}"), "payload.mass.unit: \"g\" must be \"kg\"");
  EXPECT_EQ(error("heavy"), "payload: \"heavy\" is not a finite number (kg)");
}

// Runs `body` with FJR_CONFIG_DIR set to `folder`, and puts back what was there.
template <class Body>
void with_config_dir(const std::string& folder, Body&& body) {
  const char* before = std::getenv("FJR_CONFIG_DIR");
  const std::string saved = before == nullptr ? "" : before;
  setenv("FJR_CONFIG_DIR", folder.c_str(), 1);
  body();
  before == nullptr ? unsetenv("FJR_CONFIG_DIR") : setenv("FJR_CONFIG_DIR", saved.c_str(), 1);
}

TEST(DefaultRobotFile, IsWhereTheEnvironmentSays) {
  const Folder folder;
  with_config_dir(folder.path().string(), [&] {
    try {
      default_robot_file();
      ADD_FAILURE() << "an empty folder was accepted";
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()), "robot.yaml: not in FJR_CONFIG_DIR, " + folder.path().string());
    }
    folder.write("robot.yaml", "");
    EXPECT_EQ(default_robot_file(), folder.path() / "robot.yaml");
  });
}

// Not a test: what runs below, with the library in other places, to say what it finds.
TEST(DefaultRobotFile, DISABLED_Probe) {
  try {
    std::cout << "probe:" << default_robot_file().string() << ":" << std::endl;
  } catch (const InputError& e) {
    std::cout << "probe:" << e.what() << ":" << std::endl;
  }
}

// default_robot_file() with the library that knows its place in `folder`, run from the root folder.
std::string found_from(const fs::path& folder) {
  fs::create_directories(folder);
  fs::copy_file(FJR_FOLDER_LIBRARY, folder / fs::path(FJR_FOLDER_LIBRARY).filename());
  const std::string command = "cd / && env -u FJR_CONFIG_DIR LD_LIBRARY_PATH='" + folder.string() + "' '" +
                              fs::read_symlink("/proc/self/exe").string() +
                              "' --gtest_also_run_disabled_tests --gtest_filter=DefaultRobotFile.DISABLED_Probe";
  FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) output += static_cast<char>(c);
  pclose(pipe);
  const std::size_t begin = output.find("probe:") + 6;
  return output.substr(begin, output.find(":\n", begin) - begin);
}

TEST(DefaultRobotFile, IsFoundInABuildTree) {
  const Folder folder;
  fs::create_directories(folder.path() / "config");
  folder.write("config/robot.yaml", "");
  EXPECT_EQ(found_from(folder.path() / "lib/fjr"), (folder.path() / "config/robot.yaml").string());
  for (const char* below : {"a/lib/fjr", "a/lib/x86_64-linux-gnu/fjr"}) {  // further above others may write
    EXPECT_THAT(found_from(folder.path() / below), HasSubstr("not found"));
  }
}

TEST(DefaultRobotFile, IsFoundBesideAnInstallation) {
  const Folder folder;
  fs::create_directories(folder.path() / "share/fjr/config");
  folder.write("share/fjr/config/robot.yaml", "");
  for (const char* place : {"lib/fjr", "lib/x86_64-linux-gnu/fjr"}) {
    EXPECT_EQ(found_from(folder.path() / place), (folder.path() / "share/fjr/config/robot.yaml").string());
  }
}

TEST(DefaultRobotFile, SaysWhereItLookedWhenThereIsNone) {
  const Folder folder;
  const std::string said = found_from(folder.path() / "lib/fjr");
  EXPECT_THAT(said,
              EndsWith("robot.yaml: not found; FJR_CONFIG_DIR is not set, searched " +
                       (folder.path() / "share/fjr/config").string() + ", " + (folder.path() / "config").string()));
}

// Whatever bytes a file holds: parameters or an InputError, never anything else.
TEST(Parameters, MutatedFilesAreReadOrRefused) {
  std::mt19937 random(7);
  const Folder folder;
  const std::string original = shipped_text();
  int refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string text = original;
    const int edits = 1 + static_cast<int>(random() % 6);
    for (int e = 0; e < edits; ++e) {
      const std::size_t at = random() % text.size();
      const char byte =
          static_cast<char>(random() % 3 == 0 ? random() % 256 : "{}[],:-#&*!|>'\"%@`?0\n\t "[random() % 24]);
      if (random() % 3 == 0) {
        text.erase(at, 1 + random() % 20);
      } else {
        text[at] = byte;
      }
    }
    try {
      load_parameters(folder.write("robot.yaml", text));
    } catch (const InputError&) {
      ++refused;
    } catch (const std::exception& e) {
      FAIL() << "round " << i << ": " << e.what() << "\n" << text;
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(refused, 1500);  // comments may change freely
}

}  // namespace
}  // namespace fjr
