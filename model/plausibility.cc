#include "model/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "model/dynamics.h"
#include "model/friction.h"

namespace fjr {
namespace {

// The ratios from which on a value is improbable, and impossible.
struct Bounds {
  double improbable, impossible;
};

constexpr Bounds kLeastInertia{0.85, 0.7};      // of the least that mass and centre of mass allow
constexpr Bounds kMostInertia{2, 10};           // of the most that fits into the link; counterweights stand out of it
constexpr Bounds kGravity{0.1, 0.3};            // relative difference from what masses and lengths give
constexpr Bounds kDrivingFriction{0.01, 0.05};  // of its amplitude; joint 2 of the paper has 0.002 by its fit
constexpr double kConcentrated = 0.01;          // of a rod's inertia: less is hardly a body
constexpr double kUpright = 0.97;               // of gravity: less is an inclined plane of motion
constexpr double kFewCounts = 1000;             // per revolution of a link encoder: a count is 6 mrad
constexpr double kStiffest = 200;               // [Hz] of a link on its spring: beyond it no joint is called flexible

Verdict verdict(bool doubtful, bool impossible) {
  return impossible ? Verdict::kImpossible : doubtful ? Verdict::kDoubtful : Verdict::kFine;
}

class Examination {
 public:
  explicit Examination(const Parameters& p) : p_(p) {}

  std::vector<Finding> run() {
    least_inertia();
    for (std::size_t j = 0; j < kJoints; ++j) {
      most_inertia(j);
      springs(j);
      friction(j);
      encoders(j);
      shape(j);
    }
    gravity();
    return std::move(findings_);
  }

 private:
  void find(std::string_view check, std::string_view field, std::size_t j, Verdict how, std::string sentence) {
    findings_.push_back({std::string(check), std::string(field), static_cast<int>(j) + 1, std::move(sentence), how});
  }

  double to_com(std::size_t j) const { return p_.link.com_fraction[j] * p_.link.length[j]; }

  // Parallel axis theorem: I = I_com + m r^2. Link 2's value is about its centre of mass, and positive.
  void least_inertia() {
    const double r = to_com(0), least = p_.link.mass[0] * r * r, inertia = p_.link.inertia[0];
    find("parallel axes", "link.inertia", 0,
         verdict(inertia < kLeastInertia.improbable * least, inertia < kLeastInertia.impossible * least),
         fmt::format("{:.4g} kg m^2 about the joint is {:.3g} of the {:.4g} kg m^2 that {:.4g} kg with the centre of "
                     "mass {:.4g} m from the joint (com_fraction times length) have at least",
                     inertia, inertia / least, least, p_.link.mass[0], r));
  }

  // Checks against a body between the ends of its link and as wide as the link. With the given centre of mass, its
  // inertia is largest if the mass is at both ends. A much smaller inertia than that of a rod means that the mass is in
  // a point.
  void most_inertia(std::size_t j) {
    const double mass = p_.link.mass[j], length = p_.link.length[j], width = p_.link.radius[j], r = to_com(j);
    const double at_ends = mass * ((r + width) * (length - r + width) + width * width);
    const double most = j == 0 ? at_ends + mass * r * r : at_ends, inertia = p_.link.inertia[j];
    const char* point = j == 0 ? "the joint" : "the centre of mass";
    find("inertia within the link", "link.inertia", j,
         verdict(inertia > kMostInertia.improbable * most, inertia > kMostInertia.impossible * most),
         fmt::format("{:.4g} kg m^2 about {} is {:.3g} times the most that {:.4g} kg within a link of {:.4g} m can "
                     "have, {:.4g} kg m^2",
                     inertia, point, inertia / most, mass, length, most));
    const double rod = mass * length * length / 12;
    if (j == 0) return;
    find("inertia of a rod", "link.inertia", j, verdict(inertia < kConcentrated * rod, false),
         fmt::format("{:.4g} kg m^2 about {} is {:.2g} of that of a rod of this mass and length, {:.4g} kg m^2",
                     inertia, point, inertia / rod, rod));
  }

  // By (4) both coefficients follow from masses and lengths, up to a common factor if the plane of motion is inclined.
  void gravity() {
    const auto& link = p_.link;
    const Joints<double> upright{(to_com(0) * link.mass[0] + link.length[0] * link.mass[1]) * kPaperGravity,
                                 to_com(1) * link.mass[1] * kPaperGravity};
    const double factor = link.gravity_torque[0] / upright[0];
    if (factor > 0 && factor < kUpright) {
      find("gravity", "link.gravity_torque", 0, Verdict::kDoubtful,
           fmt::format("{:.4g} N m is {:.3g} of the {:.4g} N m that masses, lengths and centres of mass give: right "
                       "for a plane of motion inclined by {:.2g} degrees from the horizontal alone",
                       link.gravity_torque[0], factor, upright[0], std::asin(factor) * 180 / std::numbers::pi));
    } else {
      find("gravity", "link.gravity_torque", 0,
           verdict(factor > 1 + kGravity.improbable, factor > 1 + kGravity.impossible),
           fmt::format("{:.4g} N m is {:.3g} times the {:.4g} N m that masses, lengths and centres of mass give",
                       link.gravity_torque[0], factor, upright[0]));
    }
    const double expected = factor * upright[1], torque = link.gravity_torque[1];
    const double slack = 2e-3 * link.gravity_torque[0];  // a balanced link 2 has nearly none
    const double off = (std::abs(torque - expected) - slack) / std::max(expected, slack);
    const Verdict how = verdict(off > kGravity.improbable, off > kGravity.impossible);
    find("gravity", "link.gravity_torque", 1, how,
         fmt::format("{:.4g} N m {} with joint 1's {:.4g} N m: masses, lengths and centres of mass then give "
                     "{:.4g} N m",
                     torque, how == Verdict::kFine ? "goes" : "does not go", link.gravity_torque[0], expected));
  }

  void springs(std::size_t j) {
    const MassMatrix<double> m = mass_matrix(p_, 0.0);
    const double inertia = j == 0 ? m.m11 : m.m22;
    const double frequency = std::sqrt(p_.spring.stiffness[j] / inertia) / (2 * std::numbers::pi);
    const bool stiff = frequency > kStiffest;
    find("flexible joint", "spring.stiffness", j, verdict(stiff, false),
         fmt::format("{:.4g} N m/rad makes the links swing at {:.3g} Hz with the other joint still{}",
                     p_.spring.stiffness[j], frequency, stiff ? ": no flexible joint" : ""));
  }

  // Checks that friction dissipates power at every speed.
  void friction(std::size_t j) {
    const FrictionLaw law = FrictionLaw::of(p_, static_cast<int>(j));
    constexpr int kSpeeds = 400;
    constexpr double kSlowest = 1e-6;  // [rad/s]
    double driving = 0, at = 0;
    for (int i = 0; i <= kSpeeds; ++i) {
      const double speed = kSlowest * std::pow(p_.limits.motor_velocity[j] / kSlowest, i / double{kSpeeds});
      if (-law.torque(speed) > driving) {
        driving = -law.torque(speed);
        at = speed;
      }
    }
    find("friction brakes", "friction.amplitude", j,
         verdict(driving > kDrivingFriction.improbable * law.amplitude,
                 driving > kDrivingFriction.impossible * law.amplitude),
         driving == 0
             ? fmt::format("this law brakes at all speeds, up to {:.4g} N m at the velocity limit",
                           law.torque(p_.limits.motor_velocity[j]))
             : fmt::format("this law drives the motor by {:.3g} N m at {:.3g} rad/s, {:.2g} % of its amplitude: {} "
                           "(viscous, amplitude, width, second_weight, second_shape)",
                           driving, at, 100 * driving / law.amplitude,
                           driving > kDrivingFriction.improbable * law.amplitude ? "friction cannot"
                                                                                 : "no more than a fit may be off"));
  }

  void encoders(std::size_t j) {
    const double counts = p_.encoder.link_counts[j];
    find("link encoder", "encoder.link_counts", j, verdict(counts < kFewCounts, false),
         fmt::format("a count is {:.3g} rad, and certificates allow deviations of one count",
                     2 * std::numbers::pi / counts));
  }

  void shape(std::size_t j) {
    const double radius = p_.link.radius[j], length = p_.link.length[j];
    const bool thick = radius > length / 2;
    find("shape", "link.radius", j, verdict(thick, false),
         thick ? fmt::format("{:.4g} m makes a link of {:.4g} m thicker than long", radius, length)
               : fmt::format("{:.4g} m is the radius of a link of {:.4g} m", radius, length));
  }

  const Parameters& p_;
  std::vector<Finding> findings_;
};

}  // namespace

std::string Finding::text() const { return fmt::format("{}.value[{}]: {}", field, joint - 1, sentence); }

std::vector<Finding> findings_about(const Parameters& p) { return Examination(p).run(); }

std::vector<Finding> doubts_about(const Parameters& p) {
  std::vector<Finding> findings = findings_about(p);
  std::erase_if(findings, [](const Finding& finding) { return finding.verdict == Verdict::kFine; });
  return findings;
}

}  // namespace fjr
