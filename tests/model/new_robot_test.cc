// Robots from short descriptions, what they are checked for, and arms that are mounted otherwise.
#include "model/new_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "model/dynamics.h"
#include "model/kinematics.h"
#include "model/robot_check.h"

namespace fjr {
namespace {

using testing::HasSubstr;

const std::string kShort = R"(length: [0.4, 0.3]
mass: [1.5, 0.7]
center_of_mass: [0.2, 0.12]
inertia: {value: [0.03, 0.016], about: [center_of_mass, joint]}
stiffness: [30, 15]
rotor_inertia: [1e-5, 4e-6]
gear: [80, 50]
torque: [14, 5]
velocity: [6, 8]
position: [[-1, 3], [-2.5, 2.5]]
deflection: [0.5, 0.3]
)";

std::string without(const std::string& key) {
  const auto begin = kShort.find(key + ":");
  return kShort.substr(0, begin) + kShort.substr(kShort.find('\n', begin) + 1);
}

Parameters robot_of(const std::string& description) {
  return new_robot(YamlNode::parse(description, "short.yaml")).parameters;
}

std::string refusal(const std::string& description) {
  try {
    robot_of(description);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(NewRobot, IsWhatWasDescribed) {
  const Parameters p = robot_of(kShort + "standard_error: {mass: [0.01, 0.02], rotor_inertia: [1e-6, 1e-7]}\n");
  EXPECT_EQ(p.link.length, (Joints<double>{0.4, 0.3}));
  EXPECT_DOUBLE_EQ(p.link.com_fraction[0], 0.5);
  EXPECT_DOUBLE_EQ(p.link.inertia[0], 0.03 + 1.5 * 0.2 * 0.2);     // parallel axes: about the joint
  EXPECT_DOUBLE_EQ(p.link.inertia[1], 0.016 - 0.7 * 0.12 * 0.12);  // and about the centre of mass
  EXPECT_DOUBLE_EQ(p.motor.inertia[0], 1e-5 * 80 * 80);
  EXPECT_DOUBLE_EQ(p.link.gravity_torque[0], (1.5 * 0.2 + 0.7 * 0.4) * 9.8);
  EXPECT_DOUBLE_EQ(p.link.gravity_torque[1], 0.7 * 0.12 * 9.8);
  EXPECT_DOUBLE_EQ(p.lowest(0), -1);
  EXPECT_DOUBLE_EQ(p.highest(0), 3);
  EXPECT_DOUBLE_EQ(p.lowest(1), -2.5);
  EXPECT_EQ(p.encoder.motor_counts, (Joints<double>{4096 * 80, 4096 * 50}));
  EXPECT_TRUE(doubts_about(p).empty());
}

TEST(NewRobot, SaysWhereEveryValueIsFrom) {
  const NewRobot robot = new_robot(YamlNode::parse(kShort + "source: CAD of May\n", "short.yaml"));
  const YamlNode root = YamlNode::parse(robot.yaml, "robot.yaml");
  Parameters unused;
  visit_parameters(unused, [&](const char* section, const char* name, const char*, Joints<double>&) {
    if (may_be_left_out(section, name) && !root.at(section).find(name)) return;
    EXPECT_THAT(root.at(section).at(name).at("source").text(),
                testing::AnyOf(testing::StartsWith("CAD of May"), testing::StartsWith("assumption: "),
                               testing::StartsWith("computed: ")))
        << section << "." << name;
  });
}

TEST(NewRobot, IsRefusedWhereItCannotBe) {
  EXPECT_EQ(refusal(without("gear")), "short.yaml: gear: missing");
  EXPECT_THAT(refusal(kShort + "stifness: [1, 2]\n"), HasSubstr("did you mean stiffness?"));
  EXPECT_EQ(refusal(without("mass") + "mass: [1.5, -0.7]\n"), "short.yaml: mass[1]: -0.7 kg must be > 0");
  EXPECT_THAT(
      refusal(without("position") + "position: [170, 150]\n"),
      HasSubstr("position[0]: 170 rad is more than two turns; angles are in rad, and 170 degrees are 2.96706 rad"));
  EXPECT_EQ(refusal(without("center_of_mass") + "center_of_mass: [0.5, 0.1]\n"),
            "short.yaml: center_of_mass[0]: 0.5 m is beyond the end of the link, 0.4 m from its joint");
  // The triangle inequality: a flat disc has Izz = Ixx + Iyy, and nothing has more.
  const auto inertia = [](const std::string& moments) {
    return without("inertia") + "inertia: [" + moments + ", 0.006]\n";
  };
  EXPECT_EQ(refusal(inertia("[0.01, 0.02, 0.03]")), "");
  EXPECT_EQ(
      refusal(inertia("[0.01, 0.02, 0.031]")),
      "short.yaml: inertia[0]: 0.031 kg m^2 is more than the other two moments together, 0.03 kg m^2: no body has "
      "that");
  // 0.001 kg m^2 about the joint, of 1.5 kg at 0.2 m: a point mass has 0.06 kg m^2.
  EXPECT_THAT(refusal(without("inertia") + "inertia: {value: [0.001, 0.006], about: [joint, center_of_mass]}\n"),
              HasSubstr("short.yaml: inertia[0]: 0.001 kg m^2 about the joint is 0.0167 of the 0.06 kg m^2"));
  EXPECT_THAT(refusal(kShort + "mounting: {inclination: 30}\n"), HasSubstr("30 degrees are 0.523599 rad"));
}

TEST(NewRobot, InertiaIsAboutOnePointOrAnotherOfEachLink) {
  const auto inertia = [](const std::string& about) {
    return without("inertia") + "inertia: {value: [0.09, 0.016], about: " + about + "}\n";
  };
  const Parameters one = robot_of(inertia("joint")), both = robot_of(inertia("[joint, joint]"));
  EXPECT_EQ(one.link.inertia, both.link.inertia);
  EXPECT_DOUBLE_EQ(one.link.inertia[0], 0.09);
  EXPECT_THAT(refusal(inertia("elbow")), HasSubstr("short.yaml: inertia.about: "));
  EXPECT_THAT(refusal(inertia("[joint]")), HasSubstr("inertia.about: must be one point for both links, or two"));
}

// 0.12 / 0.25 is not the number nearest to 0.48, nor are 1.4 + 1.2 and 1.4 - 1.2 halved those nearest to 1.3 and 0.1.
TEST(NewRobot, WritesNoDigitsThatRoundingLeft) {
  const std::string yaml = new_robot(YamlNode::parse(without("length") + "length: [0.25, 0.2]\n", "short.yaml")).yaml;
  EXPECT_THAT(yaml, HasSubstr("com_fraction: {value: [0.8, 0.6]"));
  const NewRobot uneven =
      new_robot(YamlNode::parse(without("position") + "position: [[-1.2, 1.4], [-2.2, 0.5]]\n", "short.yaml"));
  EXPECT_THAT(uneven.yaml, HasSubstr("link_position: {value: [1.3, 1.35]"));
  EXPECT_THAT(uneven.yaml, HasSubstr("link_middle: {value: [0.1, -0.85]"));
  EXPECT_THAT(uneven.yaml, testing::Not(HasSubstr("00000")));
  EXPECT_THAT(uneven.yaml, testing::Not(HasSubstr("99999")));
}

std::string verdict_of(const Parameters& p, const std::string& check, int joint) {
  for (const Finding& finding : check_robot(p)) {
    if (finding.check != check || finding.joint != joint) continue;
    return finding.verdict == Verdict::kFine       ? "fine"
           : finding.verdict == Verdict::kDoubtful ? "doubtful"
                                                   : "impossible";
  }
  return "not checked";
}

TEST(RobotCheck, FindsWhatAnArmCannotDo) {
  const Parameters good = robot_of(kShort);
  for (const char* check : {"inertia within the link", "springs hold the arm", "motors hold the arm", "range",
                            "motor encoder", "drive", "acceleration", "flexible joint"}) {
    for (const int joint : {1, 2}) EXPECT_EQ(verdict_of(good, check, joint), "fine") << check << joint;
  }
  Parameters p = good;
  p.spring.stiffness[0] = 12;  // 6.5 N m of gravity / 12 N m/rad
  EXPECT_EQ(verdict_of(p, "springs hold the arm", 1), "impossible");
  p = good;
  p.limits.torque[0] = 5;
  EXPECT_EQ(verdict_of(p, "motors hold the arm", 1), "doubtful");
  p.mounting.gravity = 0;  // on a table it is enough
  EXPECT_EQ(verdict_of(p, "motors hold the arm", 1), "fine");
  p = good;
  p.drive.peak_torque[1] = 4;
  EXPECT_EQ(verdict_of(p, "drive", 2), "impossible");
  p = good;
  p.encoder.motor_counts[0] = 1000;  // no friction to hold it, and 65 counts of the link
  EXPECT_EQ(verdict_of(p, "holding still", 1), "doubtful");
  p.friction.amplitude[0] = 1;
  EXPECT_EQ(verdict_of(p, "holding still", 1), "fine");
  p = good;
  p.motor.inertia[1] = 1e-4;
  EXPECT_EQ(verdict_of(p, "acceleration", 2), "doubtful");
  p = good;
  p.link.inertia[0] = 0.001;
  EXPECT_EQ(verdict_of(p, "parallel axes", 1), "impossible");
}

TEST(RobotCheck, TheShippedRobotsCanBe) {
  for (const char* file : {"config/robot.yaml", "config/robots/asr_twodof.yaml"}) {
    const Parameters p = load_parameters(std::filesystem::path(FJR_SOURCE_DIR) / file);
    for (const Finding& finding : check_robot(p)) EXPECT_NE(finding.verdict, Verdict::kImpossible) << finding.text();
  }
}

// ---- mounting ----

Parameters mounted(const std::string& mounting) { return robot_of(kShort + "mounting: " + mounting + "\n"); }

// The gradient of the potential energy of point masses where the links' centres of mass are, with gravity's part in the
// plane pointing to where the stretched arm points at q1 = down.
TEST(Mounting, GravityPullsWhereItIsSaidTo) {
  const double inclination = 0.6, down = 0.9, in_plane = 9.8 * std::sin(inclination);
  const Parameters p = mounted("{inclination: 0.6, down: 0.9}");
  const auto potential = [&](const Joints<double>& q) {
    const auto height = [&](double x, double y) { return -(x * std::sin(down) - y * std::cos(down)); };  // up the slope
    const double x1 = std::sin(q[0]), y1 = -std::cos(q[0]), x2 = std::sin(q[0] + q[1]), y2 = -std::cos(q[0] + q[1]);
    return in_plane * (1.5 * height(0.2 * x1, 0.2 * y1) + 0.7 * height(0.4 * x1 + 0.12 * x2, 0.4 * y1 + 0.12 * y2));
  };
  for (const Joints<double>& q : {Joints<double>{0, 0}, {0.9, 0}, {1.3, -0.7}, {-2.0, 2.2}}) {
    const Joints<double> g = gravity_torque(p, q);
    constexpr double kStep = 1e-5;  // central differences of energies of 5 J: 1e-10 of rounding and of the third order
    for (std::size_t j = 0; j < kJoints; ++j) {
      Joints<double> less = q, more = q;
      less[j] -= kStep;
      more[j] += kStep;
      EXPECT_NEAR(g[j], (potential(more) - potential(less)) / (2 * kStep), 1e-8);
    }
    EXPECT_NEAR(energy(p, rest_at(p, q)) - energy(p, State<double>{q, {}, rest_at(p, q).theta, {}}), 0, 1e-12);
  }
  EXPECT_NEAR(gravity_torque(p, Joints<double>{0.9, 0})[0], 0, 1e-14);  // hangs there
}

TEST(Mounting, OnATableThereIsNoGravity) {
  const Parameters p = mounted("{inclination: 0}");
  EXPECT_EQ(gravity_torque(p, Joints<double>{1.0, 0.5}), (Joints<double>{0, 0}));
  EXPECT_NE(robot_hash(p), robot_hash(robot_of(kShort)));
  EXPECT_EQ(robot_hash(mounted("{inclination: 1.5707963267948966, down: 0}")), robot_hash(robot_of(kShort)));
}

// Closed forms against the same formulas on dual numbers.
TEST(Mounting, DerivativesInClosedFormAgree) {
  const Parameters p = mounted("{inclination: 1.1, down: -0.7}");
  using D = Dual2<2>;
  const Joints<double> q{0.8, -1.1}, dq{1.2, -0.4}, theta{0.9, -1.0};
  const Joints<D> on_dual = link_acceleration<D>(p, {D::input(q[0], 0), D::input(q[1], 1)}, {D(dq[0]), D(dq[1])},
                                                 {p.spring.stiffness[0] * (D(theta[0]) - D::input(q[0], 0)),
                                                  p.spring.stiffness[1] * (D(theta[1]) - D::input(q[1], 1))});
  const LinkDerivatives closed = derivatives_of_link_acceleration<true>(p, q, dq, theta);
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_NEAR(closed.value[j], on_dual[j].v, 1e-10);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(closed.first[j][i], on_dual[j].g[i], 1e-9);
    EXPECT_NEAR(closed.second[j][link_derivatives::pair(1, 0)], on_dual[j].second(1, 0), 1e-8);
    EXPECT_NEAR(closed.second[j][link_derivatives::pair(0, 0)], on_dual[j].second(0, 0), 1e-8);
  }
}

}  // namespace
}  // namespace fjr
