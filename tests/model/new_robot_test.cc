// Robots from short descriptions, what they are checked for, and arms that are mounted otherwise.
#include "model/new_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

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

TEST(NewRobot, WhatItIsCalledAddsNothingToTheFile) {
  const std::string given = "name: \"a\\npayload: {mass: [3, 0]}\"\nsource: 'the \"red\" one, C:\\arms'\n";
  const NewRobot robot = new_robot(YamlNode::parse(kShort + given, "short.yaml"));
  const YamlNode root = YamlNode::parse(robot.yaml, "robot.yaml");
  EXPECT_FALSE(root.find("payload"));
  EXPECT_EQ(root.at("link").at("mass").at("source").text(), "the \"red\" one, C:\\arms");
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

// What can be found, each with the number that it rests on. Figures are worked out by hand from kShort: link 1 has 0.09
// kg m^2 about its joint, link 2 0.00592 about its centre of mass and 0.016 about its joint; gravity 5.684 and 0.8232
// N m; q2 = 0 gives m11 = 0.09 + 0.00592 + 0.7 (0.4^2 + 0.12^2 + 2 0.4 0.12) = 0.2852 kg m^2.
struct Found {
  const char* check;
  int joint;
  Verdict verdict;
  std::vector<const char*> numbers;
  std::function<void(Parameters&)> change = [](Parameters&) {};
};

constexpr double squared(double x) { return x * x; }
constexpr double kRadPerHz = 2 * std::numbers::pi;

const std::vector<Found> kFound{
    {"parallel axes", 1, Verdict::kFine, {"0.09 kg m^2 about the joint is 1.5 of the 0.06 kg m^2"}},
    {"parallel axes",
     1,
     Verdict::kDoubtful,  // 1.5 kg at 0.2 m
     {"0.048 kg m^2 about the joint is 0.8 of the 0.06 kg m^2"},
     [](Parameters& p) { p.link.inertia[0] = 0.048; }},
    {"parallel axes", 1, Verdict::kImpossible, {"is 0.0167 of"}, [](Parameters& p) { p.link.inertia[0] = 0.001; }},
    {"inertia within the link",
     1,
     Verdict::kDoubtful,  // 1.5 (0.25 0.25 + 0.05^2) at the ends of a link 0.1 m thick, and 1.5 0.2^2
     {"0.63 kg m^2 about the joint is 4 times", "1.5 kg within a link of 0.4 m can have, 0.1575 kg m^2"},
     [](Parameters& p) {
       p.link.radius[0] = 0.05;
       p.link.inertia[0] = 0.63;
     }},
    {"inertia within the link",
     2,
     Verdict::kImpossible,  // 0.7 (0.14 0.2 + 0.02^2)
     {"0.2982 kg m^2 about the centre of mass is 15 times", "0.01988 kg m^2"},
     [](Parameters& p) {
       p.link.radius[1] = 0.02;
       p.link.inertia[1] = 0.2982;
     }},
    {"inertia of a rod",
     2,
     Verdict::kDoubtful,  // 0.7 0.3^2 / 12
     {"2.625e-05 kg m^2 about the centre of mass is 0.005 of", "0.00525 kg m^2"},
     [](Parameters& p) { p.link.inertia[1] = 2.625e-5; }},
    {"flexible joint",
     1,
     Verdict::kDoubtful,
     {"at 250 Hz", "no flexible joint"},
     [](Parameters& p) { p.spring.stiffness[0] = 0.2852 * squared(250 * kRadPerHz); }},
    {"flexible joint",
     2,
     Verdict::kFine,
     {"at 150 Hz"},
     [](Parameters& p) { p.spring.stiffness[1] = 0.016 * squared(150 * kRadPerHz); }},
    {"friction brakes",
     1,
     Verdict::kImpossible,  // f tanh - 1.5 f tanh
     {"drives the motor by 0.5 N m"},
     [](Parameters& p) {
       p.friction.amplitude[0] = 1;
       p.friction.width[0] = 0.02;
       p.friction.second_weight[0] = 1.5;
       p.friction.second_shape[0] = p.friction.viscous[0] = 0;
     }},
    {"friction brakes",
     2,
     Verdict::kFine,  // at 8 rad/s
     {"brakes at all speeds, up to 2 N m"},
     [](Parameters& p) {
       p.friction.viscous[1] = 0.25;
       p.friction.amplitude[1] = 0;
     }},
    {"link encoder",
     1,
     Verdict::kDoubtful,
     {"a count is 0.0126 rad"},
     [](Parameters& p) { p.encoder.link_counts[0] = 500; }},
    {"link encoder", 2, Verdict::kFine, {"a count is 9.59e-05 rad"}},
    {"shape",
     1,
     Verdict::kDoubtful,
     {"0.25 m makes a link of 0.4 m thicker"},
     [](Parameters& p) { p.link.radius[0] = 0.25; }},
    {"shape",
     2,
     Verdict::kFine,
     {"0.05 m is the radius of a link of 0.3 m"},
     [](Parameters& p) { p.link.radius[1] = 0.05; }},
    {"gravity",
     1,
     Verdict::kImpossible,
     {"8.526 N m is 1.5 times the 5.684 N m"},
     [](Parameters& p) { p.link.gravity_torque[0] *= 1.5; }},
    {"gravity",
     1,
     Verdict::kDoubtful,  // half: a plane at 30 degrees
     {"2.842 N m is 0.5 of the 5.684 N m", "inclined by 30 degrees"},
     [](Parameters& p) { p.link.gravity_torque[0] /= 2; }},
    {"gravity",
     2,
     Verdict::kImpossible,
     {"1.646 N m does not go with joint 1's 5.684 N m", "0.8232 N m"},
     [](Parameters& p) { p.link.gravity_torque[1] *= 2; }},
    {"mass matrix", 1, Verdict::kFine, {"smallest eigenvalue is 0.0", "kg m^2, at q2 = ", ": positive definite"}},
    {"mass matrix",
     1,
     Verdict::kImpossible,  // at q2 = pi: [0.12488, -0.04352; ., -0.00992]
     {"-0.02275 kg m^2, at q2 = 3.14 rad: not positive definite"},
     [](Parameters& p) { p.link.inertia[1] = -0.02; }},
    {"springs hold the arm",
     1,
     Verdict::kImpossible,  // 6.5072 / 12
     {"by up to 0.5423 rad at rest, 108 % of the 0.5 rad"},
     [](Parameters& p) { p.spring.stiffness[0] = 12; }},
    {"springs hold the arm", 2, Verdict::kFine, {"by up to 0.05488 rad at rest, 18 % of the 0.3 rad"}},
    {"range", 1, Verdict::kFine, {"from -1 to 3 rad, 0.637 turns"}},
    {"range",
     2,
     Verdict::kDoubtful,
     {"from -10 to 10 rad, 3.18 turns", "10 degrees are 0.1745 rad"},
     [](Parameters& p) { p.limits.link_position[1] = 10; }},
    {"motor encoder",
     1,
     Verdict::kDoubtful,  // 30 N m/rad of 2 N m
     {"a count is 0.00628 rad, 0.188 N m of spring torque (9.4 % of the limit), and 6.28 rad/s"},
     [](Parameters& p) {
       p.encoder.motor_counts[0] = 1000;
       p.limits.torque[0] = 2;
     }},
    {"motor encoder", 2, Verdict::kFine, {"0.0471 N m"}, [](Parameters& p) { p.encoder.motor_counts[1] = 2000; }},
    {"holding still",
     1,
     Verdict::kDoubtful,  // 65.536 counts of 65536 a turn
     {"65.5 counts of the link", "0.314 N m, and friction 0 N m: nothing holds"},
     [](Parameters& p) {
       p.encoder.motor_counts[0] = 1000;
       p.feedback.position_gain[0] = 50;
       p.friction.amplitude[0] = 0;
     }},
    {"holding still",
     2,
     Verdict::kFine,
     {"friction 1 N m: friction holds the motor"},
     [](Parameters& p) { p.friction.amplitude[1] = 1; }},
    {"drive", 1, Verdict::kImpossible, {"7 N m is 0.5 times"}, [](Parameters& p) { p.drive.peak_torque[0] = 7; }},
    {"drive", 2, Verdict::kDoubtful, {"5.1 N m is 1.02 times"}, [](Parameters& p) { p.drive.peak_torque[1] = 5.1; }},
    {"acceleration", 1, Verdict::kFine, {"in 27.4 ms, 27.4 ticks"}},  // 0.064 kg m^2 to 6 rad/s by 14 N m
    {"acceleration",
     2,
     Verdict::kDoubtful,
     {"in 0.16 ms, 0.16 ticks"},
     [](Parameters& p) { p.motor.inertia[1] = 1e-4; }},
    {"motors hold the arm",
     1,
     Verdict::kDoubtful,
     {"up to 6.507 N m of 5;"},
     [](Parameters& p) { p.limits.torque[0] = 5; }},
    {"motors hold the arm", 1, Verdict::kFine, {"up to 6.507 N m of 14; both motors hold 100 %"}},
    {"motors hold the arm", 2, Verdict::kFine, {"up to 0.8232 N m of 5;"}},
    {"reach", 1, Verdict::kFine, {"from 0.1 to 0.7 m", "by up to 0.0671 mm"}},  // 9.59e-5 rad at 0.7 m
};

TEST(RobotCheck, EachFindingHasItsNumber) {
  for (const Found& expected : kFound) {
    Parameters p = robot_of(kShort);
    expected.change(p);
    const std::vector<Finding> findings = check_robot(p);
    const auto found = std::ranges::find_if(
        findings, [&](const Finding& f) { return f.check == expected.check && f.joint == expected.joint; });
    ASSERT_NE(found, findings.end()) << expected.check << expected.joint;
    EXPECT_EQ(found->verdict, expected.verdict) << found->text();
    for (const char* number : expected.numbers) EXPECT_THAT(found->text(), HasSubstr(number));
  }
}

TEST(RobotCheck, NothingIsFoundThatIsNotTriedHere) {
  for (const Finding& finding : check_robot(robot_of(kShort))) {
    EXPECT_TRUE(std::ranges::any_of(
        kFound, [&](const Found& f) { return f.check == finding.check && f.joint == finding.joint; }))
        << finding.check << finding.joint;
  }
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
