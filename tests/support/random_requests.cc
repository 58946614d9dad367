#include "support/random_requests.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "model/flatness.h"
#include "model/friction.h"
#include "planner/problem/problem.h"
#include "planner/problem/task/task.h"

namespace fjr {
namespace {

// The engine's bits are the same everywhere; std's distributions are not.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  bool chance(double probability) { return between(0, 1) < probability; }
  int whole(int low, int high) { return low + static_cast<int>(between(0, 1) * (high - low + 1)); }
  double magnitude(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }

 private:
  std::mt19937_64 engine_;
};

using Polynomial = std::vector<double>;  // coefficients, constant first

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial result(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) result[i + k] += a[i] * b[k];
  }
  return result;
}

// a(b(c))
Polynomial composed(const Polynomial& a, const Polynomial& b) {
  Polynomial result{0.0};
  for (std::size_t i = a.size(); i-- > 0;) {
    result = product(result, b);
    result[0] += a[i];
  }
  return result;
}

double derivative(const Polynomial& p, int order, double c) {
  double value = 0;
  for (std::size_t k = p.size(); k-- > static_cast<std::size_t>(order);) {
    double factor = 1;
    for (int i = 0; i < order; ++i) factor *= static_cast<double>(k) - i;
    value = value * c + p[k] * factor;
  }
  return value;
}

// Progress along the way in [0, 1]: with four vanishing derivatives where the arm rests, so that u is at rest too.
Polynomial progress(bool rest_at_start, bool rest_at_goal) {
  if (rest_at_start && rest_at_goal) return {0, 0, 0, 0, 0, 126, -420, 540, -315, 70};
  if (rest_at_start) return {0, 0, 0, 0, 0, 5, -4};
  if (!rest_at_goal) return {0, 1};
  Polynomial mirrored = composed({0, 0, 0, 0, 0, 5, -4}, {1, -1});
  for (double& a : mirrored) a = -a;
  mirrored[0] += 1;
  return mirrored;
}

struct Witness {
  Joints<Polynomial> q;  // of the share of the duration
  double duration = 1;

  FlatPoint at(const Parameters& robot, double c) const {
    LinkMotion m;
    for (std::size_t j = 0; j < kJoints; ++j) {
      Joints<double>* const parts[] = {&m.q, &m.dq, &m.ddq, &m.dddq, &m.ddddq};
      for (int order = 0; order <= 4; ++order) {
        (*parts[order])[j] = derivative(q[j], order, c) / std::pow(duration, order);
      }
    }
    return from_link_motion(robot, m);
  }
};

constexpr int kProbes = 400;
double share(int probe) { return static_cast<double>(probe) / kProbes; }

// What the motion takes of each limit. Where a motor reverses, its friction may have either sign.
Limits taken(const Parameters& robot, const Witness& witness) {
  constexpr double kPastTheStep = 2e-3;  // [rad/s]
  Limits most = Limits::all(0);
  const auto raise = [](double& value, double candidate) { value = std::max(value, std::abs(candidate)); };
  std::optional<FlatPoint> before;
  for (int i = 0; i <= kProbes; ++i) {
    const FlatPoint p = witness.at(robot, share(i));
    const State<double>& x = p.state;
    for (int joint = 0; joint < kJoints; ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      raise(most.torque[j], p.torque[j]);
      if (before && before->state.dtheta[j] * x.dtheta[j] <= 0) {
        const double step = std::abs(FrictionLaw::of(robot, joint).nonlinear(kPastTheStep));
        raise(most.torque[j], std::abs(p.compensated_torque[j]) + step);
      }
      raise(most.motor_velocity[j], x.dtheta[j]);
      raise(most.link_position[j], x.q[j]);
      raise(most.spring_deflection[j], x.theta[j] - x.q[j]);
      raise(most.motor_power[j], p.torque[j] * x.dtheta[j]);
      if (before) {
        raise(most.torque_rate[j],
              (p.compensated_torque[j] - before->compensated_torque[j]) * kProbes / witness.duration);
      }
    }
    raise(most.tip_speed, std::sqrt(tip_speed_squared(robot, x.q[1], x.dq)));
    before = p;
  }
  return most;
}

// Largest share of any limit.
double usage(const Limits& most, const Limits& limits) {
  double largest = 0;
  for (const LimitName& name : kLimitNames) largest = std::max(largest, name.in(most) / name.in(limits));
  return largest;
}

struct Ends {
  bool rest_at_start, rest_at_goal;
};

// A motion that takes the given share of the limits, as fast as that allows; none if it takes too long.
std::optional<Witness> draw_witness(Draw& draw, const Parameters& robot, const Ends& ends, bool straight,
                                    double wanted) {
  constexpr double kShortest = 0.05, kLongest = 3.5;  // [s]
  const Limits limits = Limits::of(robot);
  const bool small = draw.chance(0.3);
  Witness witness;
  const Polynomial s = progress(ends.rest_at_start, ends.rest_at_goal);
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double room = 0.97 * limits.link_position[j], from = draw.between(-room, room);
    const double to = small ? std::clamp(from + draw.between(-0.5, 0.5), -room, room) : draw.between(-room, room);
    const double bend = straight ? 0 : draw.between(-1, 1) * (small ? 0.3 : 1),
                 twist = straight ? 0 : draw.between(-1, 1);
    // from + (to - from) s + s (1 - s) (bend + twist (s - 1/2))
    const double constant = bend - twist / 2;
    witness.q[j] = composed({from, to - from + constant, twist - constant, -twist}, s);
  }
  double low = kShortest, high = kLongest;
  const auto fits = [&](double duration) {
    witness.duration = duration;
    return usage(taken(robot, witness), limits) <= wanted;
  };
  if (!fits(high)) return std::nullopt;
  for (int i = 0; i < 12; ++i) {
    const double middle = std::sqrt(low * high);
    (fits(middle) ? high : low) = middle;
  }
  witness.duration = high;
  return witness;
}

std::string numbers(const Joints<double>& pair) { return fmt::format("[{:.17g}, {:.17g}]", pair[0], pair[1]); }

// The request's parts, in the order in which they are drawn.
class Writer {
 public:
  Writer(const Parameters& robot, std::uint64_t seed) : robot_(robot), draw_(seed) {
    if (!draw_.chance(0.15)) return;
    robot_.payload = {draw_.magnitude(0.02, 0.5), draw_.between(0, 1e-3)};
    tell("payload");
    add("payload: {{mass: {:.17g}, inertia: {:.17g}}}", robot_.payload.mass, robot_.payload.inertia);
  }

  RandomRequest write() {
    const double kind = draw_.between(0, 1);
    const Ends ends{kind < 0.75, kind < 0.6 || (kind >= 0.75 && kind < 0.9)};
    const bool path = draw_.chance(0.06);
    std::optional<Witness> witness;
    while (!witness || !keeps_positions(*witness)) {
      witness = draw_witness(draw_, robot_, ends, path, draw_.between(0.4, 0.95));
    }
    witness_ = *witness;
    most_ = taken(robot_, witness_);
    tell(ends.rest_at_start && ends.rest_at_goal ? "rest"
         : ends.rest_at_start                    ? "moving goal"
         : ends.rest_at_goal                     ? "moving start"
                                                 : "both moving");
    add_start(ends.rest_at_start);
    add_goal(ends.rest_at_goal, path);
    const bool timed = add_duration_and_objective(ends);
    if (path) {
      tell("path");
      add("path: {{tolerance: {:.6g}}}", draw_.magnitude(0.01, 0.2));
    } else if (draw_.chance(0.25)) {
      add_vias(timed);
    }
    add_task();
    if (draw_.chance(0.3)) add_limits();
    add("sample_period: {:.6g}", draw_.chance(0.5) ? 0.001 : draw_.magnitude(0.0005, 0.005));
    return {kind_, yaml_, witness_.duration};
  }

 private:
  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    yaml_ += fmt::format(format, std::forward<Args>(args)...) + "\n";
  }
  void tell(const std::string& part) { kind_ += (kind_.empty() ? "" : ", ") + part; }

  State<double> state(double c) const { return witness_.at(robot_, c).state; }

  bool keeps_positions(const Witness& witness) const { return usage(taken(robot_, witness), Limits::of(robot_)) < 1; }

  void add_start(bool rest) {
    const State<double> x = state(0);
    if (rest) return add("start: {{q: {}}}", numbers(x.q));
    add("start: {{q: {}, dq: {}, theta: {}, dtheta: {}}}", numbers(x.q), numbers(x.dq), numbers(x.theta),
        numbers(x.dtheta));
  }

  void add_goal(bool rest, bool path) {
    const State<double> x = state(1);
    const double kind = path ? 1 : draw_.between(0, 1);
    // Where the arm is nearly stretched or folded, a tip velocity says little about the joints'.
    if (kind < 0.15 && (rest || std::abs(std::sin(x.q[1])) > 0.1)) {
      tell("tip goal");
      const Point<double> tip = tip_position(robot_, x.q), velocity = tip_velocity(robot_, x.q, x.dq);
      add("goal: {{tip: {}{}}}", numbers({tip.x, tip.y}),
          rest ? "" : fmt::format(", tip_velocity: {}", numbers({velocity.x, velocity.y})));
    } else if (kind < 0.25) {
      tell("free joint");
      const std::size_t free = draw_.chance(0.5) ? 1 : 0;
      std::array<std::string, kJoints> q{fmt::format("{:.17g}", x.q[0]), fmt::format("{:.17g}", x.q[1])};
      q[free] = "free";
      add("goal: {{q: [{}, {}]{}}}", q[0], q[1], rest ? "" : ", dq: " + numbers(x.dq));
    } else if (rest) {
      add("goal: {{q: {}}}", numbers(x.q));
    } else if (draw_.chance(0.5)) {
      add("goal: {{q: {}, dq: {}}}", numbers(x.q), numbers(x.dq));
    } else {
      add("goal: {{q: {}, dq: {}, theta: {}, dtheta: {}}}", numbers(x.q), numbers(x.dq), numbers(x.theta),
          numbers(x.dtheta));
    }
  }

  // True when the motion may have its own duration, and nothing else.
  bool add_duration_and_objective(const Ends& ends) {
    const double kind = draw_.between(0, 1);
    bool exact = false;
    if (kind < 0.45) {  // fixed; whoever rests can wait first
      exact = !(ends.rest_at_start || ends.rest_at_goal) || draw_.chance(0.5);
      const double duration = witness_.duration * (exact ? 1 : draw_.magnitude(1, 4));
      tell("fixed");
      add("duration: {:.17g}", duration);
    } else if (kind < 0.65) {
      tell("bounded");
      add("duration: {{min: {:.17g}, max: {:.17g}}}", std::max(0.02, witness_.duration * draw_.between(0.2, 1)),
          witness_.duration * draw_.between(1, 2));
    }
    add_objective(kind < 0.45);
    return exact;
  }

  void add_objective(bool fixed) {
    const std::string time = fixed ? "" : "time: 1, ";
    const int kind = !fixed && draw_.chance(0.3) ? 0 : draw_.whole(1, 10);
    const char* const names[] = {"fastest", "gentle", "efficient", "effort", "accelerations", "rates",
                                 "jerk",    "energy", "copper",    "peak",   "mixed"};
    tell(names[kind]);
    if (kind < 3) return add("objective: {}", names[kind]);
    if (kind == 3) return add("objective: {{{}effort: {:.3g}}}", time, draw_.magnitude(1e-3, 1));
    if (kind == 4) return add("objective: {{{}link_acceleration: {:.3g}}}", time, draw_.magnitude(1e-5, 1e-2));
    if (kind == 6) return add("objective: {{{}link_jerk: {:.3g}}}", time, draw_.magnitude(1e-8, 1e-4));
    if (kind == 7) return add("objective: {{{}energy: {:.3g}}}", time, draw_.magnitude(1e-2, 1));
    if (kind == 8) return add("objective: {{{}copper: {:.3g}}}", time, draw_.magnitude(1e-3, 1));
    if (kind == 9) return add("objective: {{{}peak_torque: {:.3g}}}", time, draw_.magnitude(1e-3, 1));
    if (kind == 10) {
      return add("objective: {{{}effort: {:.3g}, energy: {:.3g}, copper: {:.3g}, link_acceleration: {:.3g}}}", time,
                 draw_.magnitude(1e-3, 1), draw_.magnitude(1e-3, 1), draw_.magnitude(1e-3, 1),
                 draw_.magnitude(1e-6, 1e-2));
    }
    const double effort = draw_.chance(0.5) ? draw_.magnitude(1e-3, 1) : 0;
    add("objective: {{{}effort: {:.3g}, torque_rate: {:.3g}}}", time, effort, draw_.magnitude(1e-8, 1e-4));
  }

  void add_vias(bool timed) {
    tell(timed ? "timed via" : "via");
    const int count = draw_.whole(1, 3);
    add("via:");
    for (int i = 0; i < count; ++i) {
      const double c = (i + draw_.between(0.3, 0.9)) / (count + 0.2);
      const State<double> x = state(c);
      add("  - {{{}q: {}{}}}", timed ? fmt::format("time: {:.17g}, ", c * witness_.duration) : "", numbers(x.q),
          draw_.chance(0.3) ? ", dq: " + numbers(x.dq) : "");
    }
  }

  void add_task() {
    const double kind = draw_.between(0, 1);
    if (kind < 0.2) add_obstacles();
    if (kind >= 0.2 && kind < 0.35) add_tip_region(draw_.chance(0.4));
  }

  // Discs anywhere that the motion stays clear of.
  void add_obstacles() {
    const int wanted = draw_.whole(1, 4);
    Task task;
    for (int trial = 0; trial < 60 && static_cast<int>(task.obstacles.discs.size()) < wanted; ++trial) {
      const double away = draw_.between(0.15, 0.9), angle = draw_.between(-3.2, 3.2);
      Disc disc{{away * std::sin(angle), -away * std::cos(angle)}, draw_.magnitude(0.01, 0.15), 0};
      if (draw_.chance(0.3)) disc.margin = draw_.between(0, 0.03);
      Task alone;
      alone.obstacles.discs.push_back(disc);
      if (least_clearance(alone) > 0.005) task.obstacles.discs.push_back(disc);
    }
    if (task.obstacles.discs.empty()) return;
    tell("obstacles");
    add("obstacles:");
    for (const Disc& disc : task.obstacles.discs) {
      add("  - {{center: {}, radius: {:.17g}, margin: {:.17g}}}", numbers(disc.center), disc.radius, disc.margin);
    }
  }

  double least_clearance(const Task& task) const {
    double least = kNoLimit;
    const std::vector<TaskRow> rows = task_rows(robot_, task, 0);
    for (int i = 0; i <= kProbes; ++i) {
      const auto posture = Posture<double>::of(robot_, state(share(i)).q);
      for (const TaskRow& row : rows) least = std::min(least, row.clearance(row.value(robot_, posture)));
    }
    return least;
  }

  void add_tip_region(bool box) {
    const Point<double> from = tip_position(robot_, state(0).q), to = tip_position(robot_, state(1).q);
    Joints<double> lower{kNoLimit, kNoLimit}, upper{-kNoLimit, -kNoLimit};
    for (int i = 0; i <= kProbes; ++i) {
      const Point<double> tip = tip_position(robot_, state(share(i)).q);
      lower = {std::min(lower[0], tip.x), std::min(lower[1], tip.y)};
      upper = {std::max(upper[0], tip.x), std::max(upper[1], tip.y)};
    }
    if (box) {
      const double margin = draw_.between(0.005, 0.2);
      tell("box");
      add("tip: {{box: [{}, {}]}}", numbers({lower[0] - margin, lower[1] - margin}),
          numbers({upper[0] + margin, upper[1] + margin}));
      return;
    }
    if (std::hypot(to.x - from.x, to.y - from.y) < 0.02) return;
    Task task;
    // A line, or an arc that bulges to one side of it; its tolerance is the largest distance from it.
    const bool arc = draw_.chance(0.4);
    const double away = draw_.between(0.3, 3) * (draw_.chance(0.5) ? 1 : -1);  // of the centre, in halves of the chord
    const Joints<double> center{(from.x + to.x) / 2 - away * (to.y - from.y) / 2,
                                (from.y + to.y) / 2 + away * (to.x - from.x) / 2};
    double tolerance = 1e-3;  // [m]
    for (; tolerance < 0.8; tolerance *= 1.2) {
      if (arc) task.arc = TipArc{center, {from.x, from.y}, {to.x, to.y}, tolerance};
      if (!arc) task.line = TipLine{{from.x, from.y}, {to.x, to.y}, tolerance};
      if (least_clearance(task) > 0.02 * tolerance) break;
    }
    if (tolerance >= 0.8) return;
    tell(arc ? "arc" : "line");
    add("tip: {{{}: {{{}from: {}, to: {}, tolerance: {:.17g}}}}}", arc ? "arc" : "line",
        arc ? fmt::format("center: {}, ", numbers(center)) : "", numbers({from.x, from.y}), numbers({to.x, to.y}),
        tolerance);
  }

  // Some of the limits nearer to what the motion takes.
  void add_limits() {
    tell("limits");
    const Limits robots = Limits::of(robot_);
    Limits limits = robots;
    add("limits:");
    for (const QuantityInfo& quantity : Quantities::infos) {
      if (quantity.of_tip || !draw_.chance(quantity.of_robot ? 0.5 : 0.3)) continue;
      Joints<double>& limit = limits.*quantity.per_joint;
      for (std::size_t j = 0; j < kJoints; ++j) {
        limit[j] = std::min(quantity.in(robots, j), quantity.in(most_, j) * draw_.between(1.03, 1.6) + 0.01);
      }
      add("  {}: {}", quantity.name, numbers(limit));
    }
    add("  tip_speed: {:.17g}", most_.tip_speed * draw_.between(1.03, 1.6) + 0.01);
  }

  Parameters robot_;
  Draw draw_;
  Witness witness_;
  Limits most_;
  std::string kind_, yaml_;
};

}  // namespace

RandomRequest random_request(const Parameters& robot, std::uint64_t seed) { return Writer(robot, seed).write(); }

}  // namespace fjr
