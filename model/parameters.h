// The parameters of the robot as plain numbers, and functions that read them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>

namespace fjr {

inline constexpr int kJoints = 2;

// A quantity per joint: [0] is joint 1, [1] is joint 2.
template <class T>
using Joints = std::array<T, kJoints>;

// Returns the largest difference, by its magnitude, of a joint's values.
inline double largest_difference(const Joints<double>& a, const Joints<double>& b) {
  double largest = 0;
  for (std::size_t j = 0; j < kJoints; ++j) largest = std::max(largest, std::abs(a[j] - b[j]));
  return largest;
}

// A payload fixed to the tip: a mass, and an inertia about its own centre of mass if it is not a point mass.
struct Payload {
  double mass = 0;           // [kg]
  double inertia = 0;        // [kg m^2]
  double mass_error = 0;     // [kg]      standard error of the mass
  double inertia_error = 0;  // [kg m^2]  standard error of the inertia

  // Compares mass and inertia, but not how accurately they are known.
  bool operator==(const Payload& other) const { return mass == other.mass && inertia == other.inertia; }
};

struct Uncertainty;  // model/uncertainty.h

// The orientation of the plane of motion: upright with q = 0 hanging down, unless a file says otherwise.
struct PlaneMounting {
  double gravity = 1;  // [-]    fraction of gravity that acts in the plane: the sine of its inclination
  double down = 0;     // [rad]  q1 at which the stretched arm points down (in an inclined plane: down the slope)
  double inclination = std::numbers::pi / 2;  // [rad]  the given angle; `gravity` is its sine

  // Compares what the model depends on: an inclination beside pi/2 by rounding is upright, too.
  bool operator==(const PlaneMounting& other) const { return gravity == other.gravity && down == other.down; }
};

// The constants of the paper's model, SI units, motor quantities in link coordinates (after the gear).
// Provenance stays in the file; see config/robot.yaml for the equation of every value.
struct Parameters {
  struct Link {
    Joints<double> length;          // [m]       l1, l2
    Joints<double> mass;            // [kg]      m1, m2
    Joints<double> com_fraction;    // [-]       alpha1, alpha2: centre of mass at alpha_i l_i from joint i
    Joints<double> inertia;         // [kg m^2]  M1 about joint axis 1; M2 about link 2's centre of mass (17)
    Joints<double> gravity_torque;  // [N m]     coefficients of sin(q1) and of sin(q1+q2) in (8), the plane upright
    Joints<double> damping;         // [N m s/rad] viscous link friction; the paper's model has none
    Joints<double> radius;          // [m]       radius of the capsule around each link
  } link;
  struct Spring {
    Joints<double> stiffness;  // [N m/rad]  K
  } spring;
  struct Motor {
    Joints<double> inertia;  // [kg m^2]  J
  } motor;
  struct Friction {                // (24): B v + f tanh(v/eta) - f omega tanh(v/eta - h tanh(v/eta))
    Joints<double> viscous;        // [N m s/rad]  B
    Joints<double> amplitude;      // [N m]        f
    Joints<double> width;          // [rad/s]      eta
    Joints<double> second_weight;  // [-]          omega
    Joints<double> second_shape;   // [-]          h
  } friction;
  struct Encoder {
    Joints<double> motor_counts;  // [1/rev]  counts per revolution of theta
    Joints<double> link_counts;   // [1/rev]  counts per revolution of q
  } encoder;
  struct Limits {                      // magnitudes
    Joints<double> torque;             // [N m]    |tau_m| in a plan
    Joints<double> motor_velocity;     // [rad/s]  |dtheta|
    Joints<double> link_position;      // [rad]    |q - link_middle|
    Joints<double> link_middle{};      // [rad]    middle of the range of q; may be left out
    Joints<double> spring_deflection;  // [rad]    |theta - q|: beyond it the springs were not identified
  } limits;
  struct Feedback {                  // the executor's motor-side feedback
    Joints<double> position_gain;    // [N m/rad]
    Joints<double> velocity_gain;    // [N m s/rad]
    Joints<double> velocity_filter;  // [Hz]  cut-off of the low-pass on the differentiated encoder
  } feedback;
  struct Drive {
    Joints<double> peak_torque;            // [N m]  what the drive can give, feedback included
    Joints<double> copper_loss{0.5, 1.5};  // [W/(N m)^2]  of the windings, per squared tau_m; may be left out
  } drive;
  Payload payload{};         // none, unless the file has one
  PlaneMounting mounting{};  // as the paper's arm hangs, unless the file has another
  // Uncertainty of all parameters except the payload; null if the file contains none.
  std::shared_ptr<const Uncertainty> uncertainty{};

  // Return the lower and the upper end of the range of q [rad] of joint j.
  double lowest(std::size_t j) const { return limits.link_middle[j] - limits.link_position[j]; }
  double highest(std::size_t j) const { return limits.link_middle[j] + limits.link_position[j]; }
};

// Calls visit(section, name, unit, member) for every parameter. Loading, checking, hashing and writing all use this
// list. P is Parameters or const Parameters.
template <class P, class Visit>
void visit_parameters(P& p, Visit&& visit) {
  visit("link", "length", "m", p.link.length);
  visit("link", "mass", "kg", p.link.mass);
  visit("link", "com_fraction", "1", p.link.com_fraction);
  visit("link", "inertia", "kg m^2", p.link.inertia);
  visit("link", "gravity_torque", "N m", p.link.gravity_torque);
  visit("link", "damping", "N m s/rad", p.link.damping);
  visit("link", "radius", "m", p.link.radius);
  visit("spring", "stiffness", "N m/rad", p.spring.stiffness);
  visit("motor", "inertia", "kg m^2", p.motor.inertia);
  visit("friction", "viscous", "N m s/rad", p.friction.viscous);
  visit("friction", "amplitude", "N m", p.friction.amplitude);
  visit("friction", "width", "rad/s", p.friction.width);
  visit("friction", "second_weight", "1", p.friction.second_weight);
  visit("friction", "second_shape", "1", p.friction.second_shape);
  visit("encoder", "motor_counts", "1/rev", p.encoder.motor_counts);
  visit("encoder", "link_counts", "1/rev", p.encoder.link_counts);
  visit("limits", "torque", "N m", p.limits.torque);
  visit("limits", "motor_velocity", "rad/s", p.limits.motor_velocity);
  visit("limits", "link_position", "rad", p.limits.link_position);
  visit("limits", "link_middle", "rad", p.limits.link_middle);
  visit("limits", "spring_deflection", "rad", p.limits.spring_deflection);
  visit("feedback", "position_gain", "N m/rad", p.feedback.position_gain);
  visit("feedback", "velocity_gain", "N m s/rad", p.feedback.velocity_gain);
  visit("feedback", "velocity_filter", "Hz", p.feedback.velocity_filter);
  visit("drive", "peak_torque", "N m", p.drive.peak_torque);
  visit("drive", "copper_loss", "W/(N m)^2", p.drive.copper_loss);
}

// Returns whether an entry may be left out of robot.yaml; it then has the value of a default Parameters.
bool may_be_left_out(std::string_view section, std::string_view name);

// Upper bounds of a payload from any source: several times what the arm can hold in any posture other than hanging.
struct PayloadBound {
  double most;
  const char* unit;

  // Calls place.fail(sentence) if the value is outside the bounds.
  template <class Place>
  void check(const Place& place, double value) const {
    if (!(value >= 0 && value <= most)) place.fail(sentence_of(value));
  }
  std::string sentence_of(double value) const;
};
inline constexpr PayloadBound kPayloadMassBound{10, "kg"}, kPayloadInertiaBound{1, "kg m^2"};

class YamlNode;
// Reads a payload as in robot.yaml or a request: the mass [kg] alone, or {mass, inertia}, each of them a number or an
// entry {value, unit, source, standard_error}. Throws InputError.
Payload read_payload(const YamlNode& node);

// Reads `mounting: {inclination, down}`: the angle [rad] of the plane to the ground, and q1 [rad] at which the
// stretched arm points down.
PlaneMounting read_mounting(const YamlNode& node);

// Reads and validates a robot.yaml. Throws InputError naming file, field, value and what is allowed: unknown and
// missing keys, wrong sizes and units, NaN and infinity, and unphysical values (a mass matrix that is not positive
// definite at every q2, a spring that cannot hold gravity within its deflection limit, ...) are refused.
Parameters load_parameters(const std::filesystem::path& file);
Parameters read_parameters(const YamlNode& root);  // reads a document likewise

// Reads a robot.yaml without checking whether the arm is physically possible. Throws InputError if it is not a
// robot.yaml.
Parameters parameters_as_written(const std::filesystem::path& file);

// Like load_parameters(), but refuses (InputError) an arm with a payload or in another mounting than hanging, because
// experiments and identification assume a bare, hanging arm.
Parameters load_bare_parameters(const std::filesystem::path& file);

// Returns the robot.yaml shipped with the program, or the one in the folder FJR_CONFIG_DIR if that is set. The former
// is found relative to the library (common/library_folder.h), installed or in a build tree, from any working directory.
// Throws InputError if there is none.
std::filesystem::path default_robot_file();

// Returns the SHA-256 hash (lower-case hex) over names and values ("section.name[i]=%.17g\n", sorted), not over the
// file's bytes. Optional entries are included only if they differ from their defaults.
std::string robot_hash(const Parameters& p);

}  // namespace fjr
