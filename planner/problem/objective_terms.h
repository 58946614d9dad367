// The terms of the objective, and the place to add a new one. A term is a weight in Weights, a struct with its formula,
// and its name in Terms. Reading, hashing, optimising and reporting use that list, and so does the refusal of terms
// that a wire type has no member for.
//
// A term is the integral of running(), or the value of at_node() at one node. Formulas are templated on the scalar, for
// exact derivatives. The value of an integral in published rows follows from running(); other terms define published().
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "model/dynamics.h"
#include "model/kinematics.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

struct Motion;  // planner/trajectory/motion.h

// The objective is the sum of weights times terms; rewards count negatively.
struct Weights {
  double time = 0;
  double effort = 0;
  double torque_rate = 0;
  double link_acceleration = 0;
  double link_jerk = 0;
  double energy = 0;
  double copper = 0;
  double peak_torque = 0;
  double tip_speed = 0;
  double tracking = 0;
};

// Properties of a term, beside its formula.
struct TermInfo {
  const char* name;
  const char* unit;
  const char* meaning;  // for the list of keys; integrals are summed over the joints
  double Weights::*weight;
  double size = 1;                 // typical value over a second, which makes weights comparable
  int starts = 1;                  // number of starts worth trying: more if there are more minima
  bool sees_friction = false;      // depends on tau_m along the motion, so the friction law is sharpened in small steps
  bool settles_torque = false;     // strictly convex in tau_m or du/dt: the optimal torque needs no regularisation
  bool sees_acceleration = false;  // running() uses ddq
  bool reward = false;
  bool of_rows = true;  // false: published() needs the motion behind the rows, or the time of a release
  // Set for the first terms only, which are hashed and reported in plan.json even with a weight of zero. Others are
  // not, because each new one would change the hashes of all earlier requests.
  bool of_first_version = false;
  // Set if the term is about the uncertain arm in the executor's loop and not a function of an instant. It is optimised
  // last, from the motion that the other terms give (planner/search/tracking.h), and reported only if it has a weight.
  bool of_closed_loop = false;
};

// One instant of a motion, the argument of running().
template <class T>
struct Instant {
  const Parameters& robot;
  const State<T>& x;
  const Joints<T>& ddq;     // [rad/s^2]
  const Joints<T>& torque;  // tau_m [N m]
  double kink = 0;          // [W] width over which the corner of max(0, .) is smoothed; 0: not at all
};

// One node of a motion, the argument of at_node().
template <class T>
struct AtNode {
  const Parameters& robot;
  const State<T>& x;
  const Joints<T>& peak;  // bounds on |tau_m| along the motion [N m]
};
enum class Node { kRelease, kGoal };

// A motion as it is published, the argument of published().
struct Published {
  const Motion& motion;
  const Trajectory& rows;
  const Parameters& robot;
  double release;  // [s]
};

template <class T>
T sum_of_squares(const Joints<T>& v) {
  return v[0] * v[0] + v[1] * v[1];
}

// Returns max(0, v) with its corner smoothed over about `width`.
template <class T>
T positive_part(const T& v, double width) {
  using std::sqrt;
  return 0.5 * (v + sqrt(v * v + width * width));
}

struct Time {
  static constexpr TermInfo info{.name = "time",
                                 .unit = "s",
                                 .meaning = "duration of the motion",
                                 .weight = &Weights::time,
                                 .of_first_version = true};
  static double published(const Published& p) { return p.rows.end_time() - p.rows.start_time(); }
};

// int tau_m^2
struct Effort {
  static constexpr TermInfo info{.name = "effort",
                                 .unit = "N^2 m^2 s",
                                 .meaning = "integral of tau_m^2",
                                 .weight = &Weights::effort,
                                 .starts = 12,
                                 .sees_friction = true,
                                 .settles_torque = true,
                                 .of_first_version = true};
  template <class T>
  static T running(const Instant<T>& at) {
    return sum_of_squares(at.torque);
  }
};

// int (du/dt)^2 of the friction-compensated torque, whose rate is then the control (Features::rate in arm_ocp.h). It is
// evaluated on the motion instead of the rows, and is infinite where u jumps.
struct TorqueRate {
  static constexpr TermInfo info{
      .name = "torque_rate",
      .unit = "N^2 m^2/s",
      .meaning = "integral of (du/dt)^2, of the friction-compensated torque; u is then continuous",
      .weight = &Weights::torque_rate,
      .size = 1e4,
      .starts = 4,
      .settles_torque = true,
      .of_rows = false,
      .of_first_version = true};
  static double published(const Published& p);
};

// int ddq^2
struct LinkAcceleration {
  static constexpr TermInfo info{.name = "link_acceleration",
                                 .unit = "rad^2/s^3",
                                 .meaning = "integral of ddq^2",
                                 .weight = &Weights::link_acceleration,
                                 .size = 10,
                                 .starts = 4,
                                 .sees_acceleration = true,
                                 .of_first_version = true};
  template <class T>
  static T running(const Instant<T>& at) {
    return sum_of_squares(at.ddq);
  }
};

// int dddq^2
struct LinkJerk {
  static constexpr TermInfo info{.name = "link_jerk",
                                 .unit = "rad^2/s^5",
                                 .meaning = "integral of (d^3q/dt^3)^2",
                                 .weight = &Weights::link_jerk,
                                 .size = 1e3,
                                 .starts = 4,
                                 .sees_acceleration = true,
                                 .of_first_version = true};
  template <class T>
  static T running(const Instant<T>& at) {
    return sum_of_squares(link_jerk(at.robot, at.x, at.ddq));
  }
};

// int max(0, tau_m dtheta): what the motors give, and nothing for what they take back.
struct Energy {
  static constexpr TermInfo info{.name = "energy",
                                 .unit = "J",
                                 .meaning = "integral of max(0, tau_m dtheta), what the motors give",
                                 .weight = &Weights::energy,
                                 .starts = 12,
                                 .sees_friction = true,
                                 .of_first_version = true};
  template <class T>
  static T running(const Instant<T>& at) {
    return positive_part(T(at.torque[0] * at.x.dtheta[0]), at.kink) +
           positive_part(T(at.torque[1] * at.x.dtheta[1]), at.kink);
  }
};

// Heat in the windings: int of robot.yaml's copper_loss times tau_m^2.
struct Copper {
  static constexpr TermInfo info{
      .name = "copper",
      .unit = "J",
      .meaning = "integral of copper_loss tau_m^2, what heats the windings; copper_loss is in robot.yaml",
      .weight = &Weights::copper,
      .starts = 12,
      .sees_friction = true,
      .settles_torque = true,
      .of_first_version = true};
  template <class T>
  static T running(const Instant<T>& at) {
    const Joints<double>& loss = at.robot.drive.copper_loss;
    return loss[0] * at.torque[0] * at.torque[0] + loss[1] * at.torque[1] * at.torque[1];
  }
};

// max |tau_m|, summed over the joints, including what holding a goal at rest takes afterwards. The bound on it is an
// additional state of the problem (Features::peak in arm_ocp.h).
struct PeakTorque {
  static constexpr TermInfo info{.name = "peak_torque",
                                 .unit = "N m",
                                 .meaning = "largest |tau_m|, with what holding a goal at rest takes",
                                 .weight = &Weights::peak_torque,
                                 .size = 10,
                                 .starts = 4,
                                 .of_first_version = true};
  static constexpr Node node = Node::kGoal;
  template <class T>
  static T at_node(const AtNode<T>& at) {
    return at.peak[0] + at.peak[1];
  }
  static double published(const Published& p);
};

// Speed of the tip at the release (Problem::release), to be maximised for throws.
struct TipSpeed {
  static constexpr TermInfo info{.name = "tip_speed",
                                 .unit = "m/s",
                                 .meaning = "speed of the tip at the release; a reward, which counts negatively",
                                 .weight = &Weights::tip_speed,
                                 .starts = 8,
                                 .reward = true,
                                 .of_rows = false,
                                 .of_first_version = true};
  static constexpr Node node = Node::kRelease;
  // [m/s] Smoothing of the speed's corner at rest. The term stays monotone in the speed.
  static constexpr double kRounding = 0.1;
  template <class T>
  static T at_node(const AtNode<T>& at) {
    using std::sqrt;
    return sqrt(tip_speed_squared(at.robot, at.x.q[1], at.x.dq) + kRounding * kRounding);
  }
  static double published(const Published& p);
};

// E int |q - q_plan|^2 of the links, over the arms that the robot's uncertainty leaves possible: see
// expected_tracking_error() (planner/certificate/robust).
struct TrackingError {
  static constexpr TermInfo info{
      .name = "tracking",
      .unit = "rad^2 s",
      .meaning =
          "expected integral of the links' squared deviation from the plan, by what robot.yaml says is uncertain",
      .weight = &Weights::tracking,
      .size = 1e-6,
      .of_closed_loop = true};
};

template <class... Term>
struct TermList {
  static constexpr std::array<TermInfo, sizeof...(Term)> infos{Term::info...};
  // Calls visit(term) for one value of each type.
  template <class Visit>
  static void visit(Visit&& visit) {
    (visit(Term{}), ...);
  }
};

using Terms =
    TermList<Time, Effort, TorqueRate, LinkAcceleration, LinkJerk, Energy, Copper, PeakTorque, TipSpeed, TrackingError>;

// ---- what follows from the list ----

// Returns a term's weight with its sign: negative for rewards.
inline double signed_weight(const Weights& weights, const TermInfo& term) {
  const double weight = weights.*term.weight;
  return term.reward ? -weight : weight;
}

// Returns the weighted sum of running().
template <class T>
T running_cost(const Weights& weights, const Instant<T>& at) {
  T cost(0.0);
  Terms::visit([&](auto term) {
    if constexpr (requires { term.running(at); }) {
      const double weight = signed_weight(weights, term.info);
      if (weight != 0) cost += weight * term.running(at);
    }
  });
  return cost;
}

// Returns the weighted sum of at_node() of the terms that belong to `node`.
template <class T>
T node_cost(const Weights& weights, Node node, const AtNode<T>& at) {
  T cost(0.0);
  Terms::visit([&](auto term) {
    if constexpr (requires { term.at_node(at); }) {
      const double weight = signed_weight(weights, term.info);
      if (weight != 0 && term.node == node) cost += weight * term.at_node(at);
    }
  });
  return cost;
}

// Each returns whether a term with a weight: depends on friction; is strictly convex in the torque and so determines
// it; depends on the links' accelerations; is a reward, which is maximised; is about the closed loop. has_peak(): no
// term has more weight, by its size, than the largest torque; it depends on friction then. only_time(): no term but
// time has a weight.
bool sees_friction(const Weights& weights);
bool settles_torque(const Weights& weights);
bool has_peak(const Weights& weights);
bool only_time(const Weights& weights);
bool sees_acceleration(const Weights& weights);
bool has_reward(const Weights& weights);
bool has_closed_loop(const Weights& weights);
// Returns the weights without those of the closed loop, which are not optimised together with the others.
Weights without_closed_loop(Weights weights);
// Returns how many starts are worth trying: the most that any weighted term which depends on friction, or is a reward,
// asks for; if there is none, the fewest above one that a weighted term asks for, or one.
int starts_worth_trying(const Weights& weights);
// Returns the largest product of a weight and the size of its term.
double objective_scale(const Weights& weights);

}  // namespace fjr
