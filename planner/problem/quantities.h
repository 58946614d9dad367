// The quantities that are limited along a motion, and the place to add a new limit. A limit is a member of Limits, a
// struct with its formula, and its name in Quantities. Reading, writing, hashing, checks of the states that a request
// names, bounding, relaxing, margins, the certificate, shadow prices, plan.json and the report use that list.
//
// Formulas are templated on the scalar, for exact derivatives.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "model/dynamics.h"
#include "model/kinematics.h"
#include "model/parameters.h"

namespace fjr {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// Limits of one plan: those of robot.yaml, tightened by the request. All are magnitudes. The struct also holds other
// numbers of which there is one per limit, such as the largest values that were reached.
struct Limits {
  Joints<double> torque{kNoLimit, kNoLimit};             // [N m]    |tau_m|
  Joints<double> motor_velocity{kNoLimit, kNoLimit};     // [rad/s]  |dtheta|
  Joints<double> link_position{kNoLimit, kNoLimit};      // [rad]    |q - link_middle|
  Joints<double> spring_deflection{kNoLimit, kNoLimit};  // [rad]    |theta - q|
  Joints<double> torque_rate{kNoLimit, kNoLimit};        // [N m/s]  |du/dt| of the friction-compensated torque
  double tip_speed = kNoLimit;                           // [m/s]
  Joints<double> motor_power{kNoLimit, kNoLimit};        // [W]      |tau_m dtheta|
  Joints<double> link_middle{};  // [rad] centre of link_position's range, from robot.yaml; not a limit itself

  // Lower and upper bound of q of a joint. [rad]
  double lowest(std::size_t j) const { return link_middle[j] - link_position[j]; }
  double highest(std::size_t j) const { return link_middle[j] + link_position[j]; }

  static Limits of(const Parameters& p);     // those of robot.yaml; infinite for quantities that only requests limit
  static Limits all(double value) noexcept;  // each of them the same number, whatever its unit

  bool operator==(const Limits&) const = default;
};

// How the optimisation keeps a quantity within its limit.
enum class BoundOn {
  kState,    // bounds on a state
  kControl,  // bounds on the control du/dt, which exists only if the request needs it
  kRow,      // a path constraint
};

// How soon a motion can leave a limit that its start, a via point or its goal lies on; no margin acts until then.
enum class Leaving {
  kThere,   // the limit only counts at that state itself
  kAtOnce,  // the control changes it directly
  kSlowly,  // through the springs: as the fourth power of time
};

// How far the closed-loop rollout may exceed a limit that the plan keeps.
enum class InRollout {
  kOfPlan,    // any amount: the limit is on the plan, and feedback is judged separately
  kVelocity,  // a fraction of the limit
  kPosition,  // a count of the link encoder
};

// Properties of a limited quantity, beside its formula.
struct QuantityInfo {
  const char* name;
  const char* unit;
  const char* meaning;  // for the list of keys
  // The words before the value in a message that refuses a state of a request; null: the name.
  const char* at_state = nullptr;
  Joints<double> Limits::*per_joint = nullptr;  // either this
  double Limits::*of_tip = nullptr;             // or this
  // The limit in robot.yaml, which a request may tighten; null: only requests limit it.
  Joints<double> Parameters::Limits::*of_robot = nullptr;
  Joints<double> Limits::*middle = nullptr;  // centre from which value() is measured; null: zero
  // The limit that holds when feedback is included, and its name in robot.yaml; null: the same.
  Joints<double> Parameters::Drive::*with_feedback = nullptr;
  const char* name_with_feedback = nullptr;
  BoundOn bound = BoundOn::kRow;
  int state = 0;             // with BoundOn::kState: index of the first joint's state
  bool sees_torque = false;  // depends on tau_m
  bool squared = false;      // value() is the square of the limited quantity, because that has a corner at zero
  // Degree of value() as a polynomial between published rows, where torques are linear, velocities quadratic and
  // positions cubic: at most 3, for its extremes are found as those of a cubic. 0: no polynomial, or of a higher
  // degree; it is sampled every 0.25 ms.
  int degree = 0;
  Leaving leaving = Leaving::kThere;
  InRollout in_rollout = InRollout::kOfPlan;
  bool place = false;  // limits where the arm may be, not what it can do
  double in_stop = 1;  // factor that widens the robot's limit for controlled stops (planner/stop/stop_limits.h)
  // How far the links oscillate on their springs decides it, so that a stop of an oscillation cannot choose it.
  bool of_oscillation = false;
  // Set for the first quantities only. The hash of a request includes them even if they are not limited, and older
  // request types have members for them.
  bool of_first_version = false;

  constexpr std::size_t count() const { return of_tip ? 1 : kJoints; }
  // Returns its limit for joint index j; the tip's for any j.
  double& in(Limits& limits, std::size_t j) const { return of_tip ? limits.*of_tip : (limits.*per_joint)[j]; }
  double in(const Limits& limits, std::size_t j) const { return of_tip ? limits.*of_tip : (limits.*per_joint)[j]; }
  double counted_from(const Limits& limits, std::size_t j) const { return middle ? (limits.*middle)[j] : 0; }
  // Returns the limit that holds when feedback is included.
  double with_feedback_in(const Parameters& robot, const Limits& limits, std::size_t j) const {
    return with_feedback ? (robot.drive.*with_feedback)[j] : in(limits, j);
  }
  // Returns the magnitude of the limited quantity for a result of value().
  double magnitude(double value) const { return squared ? std::sqrt(std::max(0.0, value)) : std::abs(value); }
};

// One instant of a motion, the argument of value().
template <class T>
struct Moment {
  const Parameters& robot;
  const State<T>& x;
  const Joints<T>& torque;       // tau_m [N m]
  const Joints<T>& torque_rate;  // du/dt [N m/s]
};

struct Torque {
  static constexpr QuantityInfo info{.name = "torque",
                                     .unit = "N m",
                                     .meaning = "of each motor, |tau_m|",
                                     .at_state = "holding still here takes",
                                     .per_joint = &Limits::torque,
                                     .of_robot = &Parameters::Limits::torque,
                                     .with_feedback = &Parameters::Drive::peak_torque,
                                     .name_with_feedback = "peak_torque",
                                     .sees_torque = true,
                                     .degree = 1,
                                     .of_first_version = true};
  template <class T>
  static Joints<T> value(const Moment<T>& at) {
    return at.torque;
  }
};

struct MotorVelocity {
  static constexpr QuantityInfo info{.name = "motor_velocity",
                                     .unit = "rad/s",
                                     .meaning = "of each motor after its gear, |dtheta|",
                                     .at_state = "the motor would turn at",
                                     .per_joint = &Limits::motor_velocity,
                                     .of_robot = &Parameters::Limits::motor_velocity,
                                     .bound = BoundOn::kState,
                                     .state = kStateDtheta,
                                     .degree = 2,
                                     .leaving = Leaving::kAtOnce,
                                     .in_rollout = InRollout::kVelocity,
                                     .in_stop = 1.05,
                                     .of_first_version = true};
  template <class T>
  static Joints<T> value(const Moment<T>& at) {
    return at.x.dtheta;
  }
};

struct LinkPosition {
  static constexpr QuantityInfo info{.name = "link_position",
                                     .unit = "rad",
                                     .meaning = "of each link, |q|, or from the middle of the robot's range",
                                     .per_joint = &Limits::link_position,
                                     .of_robot = &Parameters::Limits::link_position,
                                     .middle = &Limits::link_middle,
                                     .bound = BoundOn::kState,
                                     .state = kStateQ,
                                     .degree = 3,
                                     .leaving = Leaving::kSlowly,
                                     .in_rollout = InRollout::kPosition,
                                     .place = true,
                                     .of_first_version = true};
  template <class T>
  static Joints<T> value(const Moment<T>& at) {
    const Joints<double>& middle = at.robot.limits.link_middle;
    return {at.x.q[0] - middle[0], at.x.q[1] - middle[1]};
  }
};

struct SpringDeflection {
  static constexpr QuantityInfo info{.name = "spring_deflection",
                                     .unit = "rad",
                                     .meaning = "of each spring, |theta - q|",
                                     .at_state = "the spring would be deflected by",
                                     .per_joint = &Limits::spring_deflection,
                                     .of_robot = &Parameters::Limits::spring_deflection,
                                     .degree = 3,
                                     .in_rollout = InRollout::kPosition,
                                     .in_stop = 1.01,
                                     .of_oscillation = true,
                                     .of_first_version = true};
  template <class T>
  static Joints<T> value(const Moment<T>& at) {
    return {at.x.theta[0] - at.x.q[0], at.x.theta[1] - at.x.q[1]};
  }
};

// For published rows it is the mean over any 0.5 to 1 ms (kTorqueRateSpan in planner/certificate/thresholds.h).
struct LimitedTorqueRate {
  static constexpr QuantityInfo info{.name = "torque_rate",
                                     .unit = "N m/s",
                                     .meaning = "of the friction-compensated torque, |du/dt|",
                                     .per_joint = &Limits::torque_rate,
                                     .bound = BoundOn::kControl,
                                     .of_first_version = true};
  template <class T>
  static Joints<T> value(const Moment<T>& at) {
    return at.torque_rate;
  }
};

struct LimitedTipSpeed {
  static constexpr QuantityInfo info{.name = "tip_speed",
                                     .unit = "m/s",
                                     .meaning = "of the tip",
                                     .at_state = "moves the tip at",
                                     .of_tip = &Limits::tip_speed,
                                     .squared = true,
                                     .in_rollout = InRollout::kVelocity,
                                     .of_first_version = true};
  template <class T>
  static std::array<T, 1> value(const Moment<T>& at) {
    return {tip_speed_squared(at.robot, at.x.q[1], at.x.dq)};
  }
};

// Mechanical power, given or taken back.
struct MotorPower {
  static constexpr QuantityInfo info{.name = "motor_power",
                                     .unit = "W",
                                     .meaning = "of each motor, given or taken back, |tau_m dtheta|",
                                     .per_joint = &Limits::motor_power,
                                     .sees_torque = true,
                                     .degree = 3};
  template <class T>
  static Joints<T> value(const Moment<T>& at) {
    return {at.torque[0] * at.x.dtheta[0], at.torque[1] * at.x.dtheta[1]};
  }
};

template <class... Quantity>
struct QuantityList {
  static_assert(((Quantity::info.degree >= 0 && Quantity::info.degree <= 3) && ...), "see QuantityInfo::degree");
  static_assert((((Quantity::info.per_joint != nullptr) != (Quantity::info.of_tip != nullptr)) && ...),
                "a quantity is per joint or of the tip");
  static constexpr std::array<std::reference_wrapper<const QuantityInfo>, sizeof...(Quantity)> infos{Quantity::info...};
  static constexpr std::size_t kLimits = (Quantity::info.count() + ...);
  // The index of a quantity's first limit.
  template <class Which>
  static consteval std::size_t first_limit() {
    static_assert((std::is_same_v<Which, Quantity> || ...), "a quantity that is not of the list");
    std::size_t first = 0;
    bool found = false;
    ((found = found || std::is_same_v<Which, Quantity>, first += found ? 0 : Quantity::info.count()), ...);
    return first;
  }
  // Calls visit(quantity) for one value of each type.
  template <class Visit>
  static constexpr void visit(Visit&& visit) {
    (visit(Quantity{}), ...);
  }
};

using Quantities =
    QuantityList<Torque, MotorVelocity, LinkPosition, SpringDeflection, LimitedTorqueRate, LimitedTipSpeed, MotorPower>;

// ---- what follows from the list ----

// Returns whether both are the same quantity, by name: with sanitizers, addresses are not constant expressions.
constexpr bool same_quantity(const QuantityInfo& a, const QuantityInfo& b) {
  return std::string_view(a.name) == b.name;
}

// Number of limits. Their indices follow the order of the list and then of the joints.
inline constexpr std::size_t kLimits = Quantities::kLimits;

struct LimitName {
  const QuantityInfo* quantity;
  int joint;  // 1 or 2; 0: of the tip

  double& in(Limits& limits) const { return quantity->in(limits, j()); }
  double in(const Limits& limits) const { return quantity->in(limits, j()); }
  constexpr std::size_t j() const { return joint == 0 ? 0 : static_cast<std::size_t>(joint - 1); }
  bool is_of(const QuantityInfo& info) const { return same_quantity(*quantity, info); }
};

inline constexpr std::array<LimitName, kLimits> kLimitNames = [] {
  std::array<LimitName, kLimits> names{};
  std::size_t next = 0;
  for (const QuantityInfo& info : Quantities::infos) {
    for (std::size_t j = 0; j < info.count(); ++j) names[next++] = {&info, info.of_tip ? 0 : static_cast<int>(j) + 1};
  }
  return names;
}();

inline Limits Limits::all(double value) noexcept {
  Limits limits;
  for (const LimitName& limit : kLimitNames) limit.in(limits) = value;
  return limits;
}

// Returns the index of the first limit of a quantity of the list.
constexpr std::size_t first_limit_of(const QuantityInfo& quantity) {
  std::size_t first = 0;
  for (const QuantityInfo& other : Quantities::infos) {
    if (same_quantity(other, quantity)) return first;
    first += other.count();
  }
  throw std::logic_error("a quantity that is not of the list");
}

// Returns the unit of a limit: "torque" -> "N m"; "" if there is no limit of that name.
std::string_view unit_of_limit(std::string_view name);

// Raises those numbers that `which` chooses by QuantityInfo to the magnitudes at this instant, if these are larger.
template <class Which>
void raise(Limits& largest, const Moment<double>& at, const Which& which) {
  Quantities::visit([&](auto quantity) {
    if (!which(quantity.info)) return;
    const auto values = quantity.value(at);
    for (std::size_t j = 0; j < values.size(); ++j) {
      double& most = quantity.info.in(largest, j);
      most = std::max(most, quantity.info.magnitude(values[j]));
    }
  });
}

// Returns whether the quantity has a finite limit for any joint.
inline bool is_limited(const QuantityInfo& info, const Limits& limits) {
  for (std::size_t j = 0; j < info.count(); ++j) {
    if (info.in(limits, j) < kNoLimit) return true;
  }
  return false;
}

}  // namespace fjr
