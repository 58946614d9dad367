// Creates a robot.yaml from basic data of an arm: lengths, masses, springs, drives. Unknown values are assumed, and
// marked as assumptions.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "common/key.h"
#include "common/strict_yaml.h"
#include "model/parameters.h"

namespace fjr {

// The inertia Izz about the axis of motion and, if all three are known, the other principal moments of the body.
struct GivenInertia {
  Joints<std::array<double, 3>> moments{};        // Ixx, Iyy, Izz
  Joints<bool> all_known{};                       // false: only Izz is known
  Joints<bool> about_center_of_mass{true, true};  // false: about the joint
};

// The range of each joint.
struct GivenRange {
  Joints<double> lowest{}, highest{};
};

struct GivenFriction {
  Joints<double> viscous{}, coulomb{};
  std::optional<Joints<double>> width;
};

// The short description of an arm; its required entries fit on a page.
struct RobotDescription {
  std::optional<std::string> name, source;
  Joints<double> length{}, mass{}, center_of_mass{};
  GivenInertia inertia;
  Joints<double> stiffness{}, rotor_inertia{}, gear{};
  Joints<double> torque{}, velocity{}, deflection{};
  GivenRange position;
  std::optional<Joints<double>> peak_torque, gravity_torque, damping, radius, motor_encoder, link_encoder;
  std::optional<GivenFriction> friction;
  std::optional<YamlNode> standard_error, mounting, payload;
};

// Calls visit(key, member) in the order in which the user is asked for the values.
template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, RobotDescription>
void visit(R& r, Visit&& v) {
  v(Key{"name", "", "what the arm is called", "\"an arm\""}, r.name);
  v(Key{"source", "", "where these values are from, for the file", "\"given to fjr robot new\""}, r.source);
  v(Key{"length", "m", "from joint 1 to joint 2, from joint 2 to the tip", kNeeded}, r.length);
  v(Key{"mass", "kg", "of each link, with what is fixed to it (the motor of joint 2, if link 1 carries it)", kNeeded},
    r.mass);
  v(Key{"center_of_mass", "m", "from the link's joint, along the link", kNeeded}, r.center_of_mass);
  v(Key{"inertia", "kg m^2",
        "about the axis of motion through the centre of mass, [I1, I2]; or {value: [I1, I2], about: [joint, "
        "center_of_mass]} or {..., about: joint}; I may be [Ixx, Iyy, Izz]",
        kNeeded},
    r.inertia);
  v(Key{"stiffness", "N m/rad", "of the springs", kNeeded}, r.stiffness);
  v(Key{"rotor_inertia", "kg m^2", "of the rotors, before the gear", kNeeded}, r.rotor_inertia);
  v(Key{"gear", "1", "ratios: turns of the motor for one of the joint", kNeeded}, r.gear);
  v(Key{"torque", "N m", "that plans may use, after the gear", kNeeded}, r.torque);
  v(Key{"velocity", "rad/s", "of the motors, after the gear", kNeeded}, r.velocity);
  v(Key{"position", "rad", "of the links: [q1, q2] to either side of 0, or [[lowest, highest], [lowest, highest]]",
        kNeeded},
    r.position);
  v(Key{"deflection", "rad", "of the springs, as far as they are linear", kNeeded}, r.deflection);
  v(Key{"peak_torque", "N m", "of the drives, with feedback", "1.2 times torque"}, r.peak_torque);
  v(Key{"gravity_torque", "N m", "coefficients of sin q1 and sin(q1 + q2), the plane upright",
        "from masses and lengths"},
    r.gravity_torque);
  v(Key{"damping", "N m s/rad", "viscous, of the links", "0"}, r.damping);
  v(Key{"radius", "m", "of the links, for obstacles", "8 % of the lengths"}, r.radius);
  v(Key{"motor_encoder", "1/rev", "counts per turn of the motor, before the gear", "4096"}, r.motor_encoder);
  v(Key{"link_encoder", "1/rev", "counts per turn of the joint", "65536"}, r.link_encoder);
  v(Key{"friction", "", "{viscous: [N m s/rad], coulomb: [N m], width: [rad/s]} of the motors, after the gear", "none"},
    r.friction);
  v(Key{"standard_error", "", "{mass: [kg, kg], ...}: of any of the keys with two numbers", "not known"},
    r.standard_error);
  v(Key{"mounting", "", "{inclination: rad, down: rad} of the plane of motion", "upright, hanging at q = 0"},
    r.mounting);
  v(Key{"payload", "kg", "fixed to the tip: a mass, or {mass, inertia}", "none"}, r.payload);
}

// Returns the keys with unit, meaning and default.
std::vector<Key> description_keys();

// Checks the value of one key independently of the others. Throws InputError if it is not allowed.
void check_answer(const Key& key, const YamlNode& value);

// Throws InputError for what is missing, unknown, or contradicts itself (triangle inequality of the moments).
RobotDescription read_description(const YamlNode& root);

// A complete robot.yaml, and the parameters read from it.
struct NewRobot {
  std::string yaml;
  Parameters parameters;
};

// Creates the robot.yaml of a description. Throws InputError as read_description() does, and if the arm is physically
// impossible, naming the responsible key of the description.
NewRobot new_robot(const YamlNode& root);

}  // namespace fjr
