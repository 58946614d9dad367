#include "model/robot_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "model/dynamics.h"

namespace fjr {
namespace {

constexpr int kPostures = 120;        // of each joint, over its range
constexpr double kNearlyAll = 0.8;    // of the spring's range, for gravity: little is left to move with
constexpr double kLittleMore = 1.05;  // times the torque limit: less leaves feedback no authority
constexpr double kCoarse = 0.05;      // of the torque limit, by a count of the motor's encoder at the spring
constexpr double kWithin = 0.2;  // of a count of the link: a motor that wanders less swings the link by less than one
constexpr double kTick = 1e-3;   // [s] of the executor
constexpr double kFewTicks = 5;  // to full speed: torque that is planned as piecewise linear cannot follow
constexpr double kTurn = 2 * std::numbers::pi;

class Abilities {
 public:
  explicit Abilities(const Parameters& p) : p_(p) {}

  std::vector<Finding> run() {
    mass_matrix_is_positive();
    for (std::size_t j = 0; j < kJoints; ++j) {
      spring_holds(j);
      range(j);
      motor_encoder(j);
      holding(j);
      drive(j);
      acceleration(j);
    }
    motors_hold();
    reach();
    return std::move(findings_);
  }

 private:
  void find(const char* check, const char* field, std::size_t j, Verdict how, std::string sentence) {
    findings_.push_back({check, field, static_cast<int>(j) + 1, std::move(sentence), how});
  }

  // The determinant is quadratic in cos q2 with a negative leading coefficient: smallest at q2 = 0 or pi.
  void mass_matrix_is_positive() {
    double least = std::numeric_limits<double>::infinity(), at = 0;
    for (const double q2 : {0.0, std::numbers::pi}) {
      const MassMatrix<double> m = mass_matrix(p_, q2);
      const double eigenvalue = 0.5 * (m.m11 + m.m22) - std::hypot(0.5 * (m.m11 - m.m22), m.m12);
      if (eigenvalue < least) {
        least = eigenvalue;
        at = q2;
      }
    }
    find("mass matrix", "link.inertia", 0, least > 0 ? Verdict::kFine : Verdict::kImpossible,
         fmt::format("its smallest eigenvalue is {:.4g} kg m^2, at q2 = {:.3g} rad: {}positive definite", least, at,
                     least > 0 ? "" : "not "));
  }

  // Compares the largest gravity torque in any posture with the torque at the spring's deflection limit.
  void spring_holds(std::size_t j) {
    const Joints<double> gravity = gravity_coefficients(p_), worst{gravity[0] + gravity[1], gravity[1]};
    const double deflection = worst[j] / p_.spring.stiffness[j], limit = p_.limits.spring_deflection[j];
    const Verdict how = deflection > limit                ? Verdict::kImpossible
                        : deflection > kNearlyAll * limit ? Verdict::kDoubtful
                                                          : Verdict::kFine;
    find("springs hold the arm", "spring.stiffness", j, how,
         fmt::format("gravity deflects this spring by up to {:.4g} rad at rest, {:.0f} % of the {:.4g} rad that are "
                     "allowed",
                     deflection, 100 * deflection / limit, limit));
  }

  void range(std::size_t j) {
    const double width = p_.highest(j) - p_.lowest(j), limit = p_.limits.link_position[j];
    const bool turns = width > 2 * kTurn;
    find("range", "limits.link_position", j, turns ? Verdict::kDoubtful : Verdict::kFine,
         fmt::format("from {:.4g} to {:.4g} rad, {:.3g} turns{}", p_.lowest(j), p_.highest(j), width / kTurn,
                     turns ? fmt::format("; angles are in rad, and {:.4g} degrees are {:.4g} rad", limit,
                                         limit * std::numbers::pi / 180)
                           : ""));
  }

  void motor_encoder(std::size_t j) {
    const double count = kTurn / p_.encoder.motor_counts[j], torque = count * p_.spring.stiffness[j];
    const double fraction = torque / p_.limits.torque[j];
    find(
        "motor encoder", "encoder.motor_counts", j, fraction > kCoarse ? Verdict::kDoubtful : Verdict::kFine,
        fmt::format("a count is {:.3g} rad, {:.3g} N m of spring torque ({:.2g} % of the limit), and {:.3g} rad/s from "
                    "one tick to the next",
                    count, torque, 100 * fraction, count / kTick));
  }

  // Checks holding. Within a count of the encoder the feedback has no error signal; without enough friction the motor
  // drifts there, and the link with it.
  void holding(std::size_t j) {
    const double count = kTurn / p_.encoder.motor_counts[j], exact = kTurn / p_.encoder.link_counts[j];
    const double torque = count * p_.feedback.position_gain[j], friction = p_.friction.amplitude[j];
    const bool wanders = friction < torque && count > kWithin * exact;
    find("holding still", "encoder.motor_counts", j, wanders ? Verdict::kDoubtful : Verdict::kFine,
         fmt::format("a count of the motor is {:.3g} counts of the link, the feedback's torque for it {:.3g} N m, and "
                     "friction {:.3g} N m: {}",
                     count / exact, torque, friction,
                     wanders             ? "nothing holds the links within one of their counts"
                     : friction < torque ? "the links stay within one of their counts"
                                         : "friction holds the motor"));
  }

  void drive(std::size_t j) {
    const double ratio = p_.drive.peak_torque[j] / p_.limits.torque[j];
    const Verdict how = ratio < 1 ? Verdict::kImpossible : ratio < kLittleMore ? Verdict::kDoubtful : Verdict::kFine;
    find("drive", "drive.peak_torque", j, how,
         fmt::format("{:.4g} N m is {:.3g} times what plans may use, the rest is for feedback", p_.drive.peak_torque[j],
                     ratio));
  }

  void acceleration(std::size_t j) {
    const double time = p_.motor.inertia[j] * p_.limits.motor_velocity[j] / p_.limits.torque[j];
    find("acceleration", "motor.inertia", j, time < kFewTicks * kTick ? Verdict::kDoubtful : Verdict::kFine,
         fmt::format("the motor alone comes to its velocity limit in {:.3g} ms, {:.3g} ticks", 1e3 * time,
                     time / kTick));
  }

  // Checks the motors in postures over the ranges of the joints.
  void motors_hold() {
    Joints<double> most{};
    int held = 0;
    for (int a = 0; a <= kPostures; ++a) {
      for (int b = 0; b <= kPostures; ++b) {
        const Joints<double> q{std::lerp(p_.lowest(0), p_.highest(0), a / double{kPostures}),
                               std::lerp(p_.lowest(1), p_.highest(1), b / double{kPostures})};
        const Joints<double> gravity = gravity_torque(p_, q);
        bool both = true;
        for (std::size_t j = 0; j < kJoints; ++j) {
          most[j] = std::max(most[j], std::abs(gravity[j]));
          both = both && std::abs(gravity[j]) <= p_.limits.torque[j];
        }
        held += both ? 1 : 0;
      }
    }
    const double fraction = held / double{(kPostures + 1) * (kPostures + 1)};
    for (std::size_t j = 0; j < kJoints; ++j) {
      const bool enough = most[j] <= p_.limits.torque[j];
      find("motors hold the arm", "limits.torque", j, enough ? Verdict::kFine : Verdict::kDoubtful,
           fmt::format("holding still takes up to {:.4g} N m of {:.4g}; both motors hold {:.3g} % of the postures",
                       most[j], p_.limits.torque[j], 100 * fraction));
    }
  }

  void reach() {
    const double near = std::abs(p_.link.length[0] - p_.link.length[1]), far = p_.link.length[0] + p_.link.length[1];
    const double count = kTurn / p_.encoder.link_counts[0];
    find("reach", "link.length", 0, Verdict::kFine,
         fmt::format("the tip reaches from {:.4g} to {:.4g} m from the base, and a count of joint 1 moves it by up to "
                     "{:.3g} mm",
                     near, far, 1e3 * count * far));
  }

  const Parameters& p_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> check_robot(const Parameters& p) {
  std::vector<Finding> findings = findings_about(p), abilities = Abilities(p).run();
  findings.insert(findings.end(), abilities.begin(), abilities.end());
  return findings;
}

}  // namespace fjr
