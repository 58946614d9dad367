#include "planner/stop/stop_motion.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "planner/certificate/limits.h"
#include "planner/control/motor_feedback.h"
#include "planner/stop/stop_limits.h"
#include "planner/stop/stop_shape.h"

namespace fjr {
namespace {

constexpr double kLonger = 1.1;                    // ratio of consecutive durations in the search
constexpr double kSoon = 0.3;                      // [s] before the end of the plan only the simpler shapes are tried
constexpr double kAimed = 0.98, kAllowed = 0.999;  // fractions of the limits, since only some instants are checked
constexpr int kNodes = 48;                         // number of these instants
constexpr int kIterations = 15, kHopeless = 4;     // the search gives up after kHopeless if still far outside
constexpr double kMissedTorque = 0.02;             // [N m] allowed interpolation error between samples
constexpr double kSharpCorner = 1000;  // [N m/s] slope change at which the rollout ends a step; halves its time
constexpr double kSameInstant = 1e-9;  // [s]
constexpr double kRestAfter = 0.25;    // [s] a quarter of the slowest oscillation, enough to show its amplitude

using Free = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kJoints * kShapes, 1>;
using Excess = Eigen::Matrix<double, kStopLimits * kNodes, 1>;

// Searches the free parameters for which a stop of a given duration is within the limits.
class Search {
 public:
  Search(const Parameters& robot, const Limits& limits, const LinkMotion& from, double duration, int shapes)
      : robot_(robot),
        limits_(in_order(limits)),
        shapes_(shapes_from(from, duration)),
        duration_(duration),
        count_(shapes) {
    free_ = Free::Zero(kJoints * count_);
    for (int j = 0; j < kJoints; ++j) {
      const auto i = static_cast<std::size_t>(j);
      free_[j * count_] = 0.45 * from.dq[i] * duration;  // roughly the distance of a stop without limits
    }
  }

  // Minimises the squared excess over kAimed of the limits by the Levenberg-Marquardt method; the problem is almost
  // linear. Returns whether the stop is within kAllowed of the limits.
  bool run() {
    Excess excess = measure(free_);
    double damping = 1e-3;
    for (int i = 0; i < kIterations && worst_ > kAllowed; ++i) {
      const double before = excess.squaredNorm(), worst = worst_;
      const Free next = free_ + step(excess, damping);
      const Excess there = measure(next);
      if (there.squaredNorm() >= before) {
        worst_ = worst;
        damping *= 10;
        if (damping > 100) break;
        continue;
      }
      free_ = next;
      excess = there;
      damping *= 0.2;
      if (before - excess.squaredNorm() < 1e-3 * before || (i >= kHopeless && worst_ > 1.5)) break;
    }
    return worst_ <= kAllowed;
  }

  Joints<std::array<double, kShapes>> free() const {
    const Joints<StopShape> s = with(free_);
    return {s[0].free, s[1].free};
  }

 private:
  Joints<StopShape> with(const Free& free) const {
    Joints<StopShape> s = shapes_;
    for (int j = 0; j < kJoints; ++j) {
      for (int i = 0; i < count_; ++i) {
        s[static_cast<std::size_t>(j)].free[static_cast<std::size_t>(i)] = free[j * count_ + i];
      }
    }
    return s;
  }

  Excess measure(const Free& free) {
    static const ShapeTable table(kNodes);
    const Joints<StopShape> s = with(free);
    Excess excess;
    worst_ = 0;
    for (int n = 1; n <= kNodes; ++n) {
      const FlatPoint p = from_link_motion(robot_, in_time({table.at(s[0], n), table.at(s[1], n)}, duration_));
      const PerStopLimit values = stop_values(robot_, p.state, p.torque);
      for (std::size_t i = 0; i < kStopLimits; ++i) {
        const double fraction = values[i] / limits_[i], size = std::abs(fraction);
        worst_ = std::max(worst_, size);
        const auto row = static_cast<Eigen::Index>(kStopLimits * static_cast<std::size_t>(n - 1) + i);
        excess[row] = std::copysign(std::max(0.0, size - kAimed), fraction);
      }
    }
    return excess;
  }

  Free step(const Excess& excess, double damping) {
    constexpr double kDifference = 1e-5;
    Eigen::Matrix<double, Excess::RowsAtCompileTime, Eigen::Dynamic> slopes(excess.size(), free_.size());
    for (Eigen::Index i = 0; i < free_.size(); ++i) {
      Free moved = free_;
      moved[i] += kDifference;
      slopes.col(i) = (measure(moved) - excess) / kDifference;
    }
    Eigen::MatrixXd normal = slopes.transpose() * slopes;
    const double floor = 1e-9 * normal.trace() + 1e-300;
    normal.diagonal() *= 1 + damping;
    normal.diagonal().array() += floor;
    return -normal.ldlt().solve(slopes.transpose() * excess);
  }

  const Parameters& robot_;
  const PerStopLimit limits_;
  Joints<StopShape> shapes_;
  double duration_;
  int count_;
  Free free_;
  double worst_ = 0;
};

LinkMotion motion_of(const Parameters& robot, const Sample& from) {
  Joints<double> u;
  for (std::size_t j = 0; j < kJoints; ++j) {
    u[j] = from.torque[j] - FrictionLaw::of(robot, static_cast<int>(j)).nonlinear(from.state.dtheta[j]);
  }
  return link_motion(robot, from.state, u);
}

// Computes the samples of a stop: every millisecond, and more where linear interpolation of the torque would miss the
// friction torque: where it jumps because a motor reverses, starts or comes to rest.
class Rows {
 public:
  Rows(const Parameters& robot, const Joints<StopShape>& shapes, double start, double duration)
      : robot_(robot), shapes_(shapes), start_(start), duration_(duration) {}

  std::vector<Sample> every_millisecond() const {
    const auto count = static_cast<int>(std::ceil(duration_ / kTick - 1e-6));
    std::vector<Sample> rows;
    for (int i = 0; i <= count; ++i) rows.push_back(row(i == count ? duration_ : i * kTick));
    rest(rows.back());
    return rows;
  }

  Trajectory between(const std::vector<Sample>& rows) const {
    Trajectory out;
    out.samples.push_back(rows.front());
    for (std::size_t i = 1; i < rows.size(); ++i) add_up_to(out.samples, rows[i]);
    return out;
  }

 private:
  Sample row(double at) const {
    const double s = at / duration_;
    const FlatPoint p =
        from_link_motion(robot_, in_time({evaluate(shapes_[0], s), evaluate(shapes_[1], s)}, duration_));
    return {start_ + at, p.state, p.torque};
  }

  // Sets the last sample exactly to rest, because rounding leaves small velocities.
  void rest(Sample& last) const {
    last.state = rest_at(robot_, last.state.q);
    last.torque = gravity_torque(robot_, last.state.q);
  }

  void add_up_to(std::vector<Sample>& rows, const Sample& to) const {
    const Sample from = rows.back();
    if (to.time - from.time > 2 * kJumpSpacing) {
      const Sample middle = row(0.5 * (from.time + to.time) - start_);
      double missed = 0;
      for (std::size_t j = 0; j < kJoints; ++j) {
        missed = std::max(missed, std::abs(middle.torque[j] - 0.5 * (from.torque[j] + to.torque[j])));
      }
      if (missed > kMissedTorque) {
        add_up_to(rows, middle);
        return add_up_to(rows, to);
      }
    }
    rows.push_back(to);
  }

  const Parameters& robot_;
  const Joints<StopShape>& shapes_;
  double start_, duration_;
};

// Checks the limits at the samples, before an expensive rollout. Returns what is wrong, if anything is.
std::optional<std::string> fault_of_rows(const Parameters& robot, const std::vector<Sample>& rows) {
  const PerStopLimit limits = in_order(stop_limits(robot));
  for (const Sample& row : rows) {
    const PerStopLimit values = stop_values(robot, row.state, row.torque);
    for (std::size_t i = 0; i < kStopLimits; ++i) {
      if (std::abs(values[i]) <= limits[i]) continue;
      const LimitName& name = kStopLimitNames[i];
      return fmt::format("{} of joint {} reaches {:.6g} at {:.6f} s, the limit of a stop is {:.6g}",
                         name.quantity->name, name.joint, values[i], row.time, limits[i]);
    }
  }
  return std::nullopt;
}

Trajectory with_rest(const Parameters& robot, const Trajectory& stop) {
  Trajectory t = stop;
  Sample last = t.samples.back();
  last.state = rest_at(robot, last.state.q);
  last.torque = gravity_torque(robot, last.state.q);
  last.time += kRestAfter;
  t.samples.push_back(last);
  return t;
}

double instant_of_stop(const Trajectory& plan, std::size_t i) {
  return plan.start_time() + static_cast<double>(i) * kStopSpacing;
}

bool can_be_used(const Parameters& robot, const Sample& from, const StopMotion& stop) {
  try {
    return !fault_of_stop(robot, stop_rows(robot, from, stop));
  } catch (const NoStop&) {
    return false;
  }
}

}  // namespace

double stop_exactness(const Parameters& robot) { return 2 * exactness_tolerance(robot); }

std::optional<StopMotion> find_stop(const Parameters& robot, const Sample& from, double shortest, double longest) {
  const Limits limits = stop_limits(robot);
  const LinkMotion motion = motion_of(robot, from);
  for (const int shapes : {4, kShapes}) {
    if (shapes == kShapes && longest < kSoon) break;
    for (double duration = std::max(shortest, kShortestStop); duration <= longest; duration *= kLonger) {
      Search search(robot, limits, motion, duration, shapes);
      if (!search.run()) continue;
      const StopMotion stop{from.time, duration, search.free()};
      if (can_be_used(robot, from, stop)) return stop;
    }
  }
  return std::nullopt;
}

Trajectory stop_rows(const Parameters& robot, const Sample& from, const StopMotion& stop) {
  Joints<StopShape> shapes = shapes_from(motion_of(robot, from), stop.duration);
  for (std::size_t j = 0; j < kJoints; ++j) shapes[j].free = stop.free[j];
  const Rows rows(robot, shapes, from.time, stop.duration);
  const std::vector<Sample> coarse = rows.every_millisecond();
  if (const auto fault = fault_of_rows(robot, coarse)) throw NoStop(*fault);
  return rows.between(coarse);
}

// The rollout leaves out the dither during the rest. It would move a link by a tenth of a count, where two are allowed,
// but would take nine tenths of the time, and a check has to be several times faster than the motion.
std::optional<std::string> fault_of_stop(const Parameters& robot, const Trajectory& stop) {
  const Trajectory t = with_rest(robot, stop);
  Drive drive = Drive::closed_loop(t, robot);
  drive.dither.reset();
  const Limits limits = stop_limits(robot);
  Rollout rollout(robot, rollout_allowance(robot, limits), Accuracy::of_predictions());
  const Comparison closed = compare(rollout, robot, t, drive, comparison_instants(t), kSharpCorner);
  if (!closed.errors.completed) return closed.errors.failure;
  for (const LimitCheck& check : check_limits(robot, limits, stop, closed)) {
    if (!check.passed) return violation(check, limits);
  }
  const double allowed = stop_exactness(robot);
  if (closed.errors.max_link() <= allowed) return std::nullopt;
  return fmt::format("a link is up to {:.2e} rad off the stop, allowed {:.2e} rad", closed.errors.max_link(), allowed);
}

std::size_t count_of_stops(const Trajectory& plan) {
  std::size_t count = 0;
  while (instant_of_stop(plan, count) < plan.end_time()) ++count;
  return count;
}

std::vector<StopMotion> stop_motions(const Parameters& robot, const Trajectory& plan,
                                     const std::function<void()>& between) {
  std::vector<StopMotion> stops;
  Interpolator at(plan);
  double shortest = 0;
  for (std::size_t i = 0; i < count_of_stops(plan); ++i) {
    const double time = instant_of_stop(plan, i), left = plan.end_time() - time;
    const auto stop = find_stop(robot, at.at(time), shortest, std::min(left, kLongestStop));
    if (!stop && left > kLongestStop) {
      throw NoStop(fmt::format("no motion was found that stops it at {:.3f} s within the limits", time));
    }
    shortest = stop ? stop->duration / (kLonger * kLonger) : 0;
    stops.push_back(stop.value_or(StopMotion{time, 0, {}}));
    if (between) between();
  }
  return stops;
}

Trajectory checked_stop(const Parameters& robot, const Trajectory& plan, std::size_t i, const StopMotion& stop) {
  const double time = instant_of_stop(plan, i);
  const auto refuse = [time](const std::string& why) {
    throw NoStop(fmt::format("the stop motion at {:.3f} s cannot be used: {}", time, why));
  };
  if (!(std::abs(stop.time - time) <= kSameInstant)) refuse(fmt::format("it begins at {:.6g} s", stop.time));
  // If the plan has no stop for this instant, that claim is not checked. A search takes 10 ms per instant on average on
  // reach.yaml, and 47 ms (at most 99 ms) on a flat motion at the limits, but instants are 20 ms apart and stops are
  // checked 100 ms ahead. Nor would finding a stop prove the claim false, because the planner's own search, which
  // starts near the previous stop, missed one of six there. It is safe: the arm continues to the end of the motion,
  // which has been certified, for at most kLongestStop.
  if (stop.duration == 0 && plan.end_time() - time <= kLongestStop) return {};
  if (!(stop.duration >= kShortestStop && stop.duration <= kLongestStop)) {
    refuse(fmt::format("it takes {:.6g} s, {:g} to {:g} s are allowed", stop.duration, kShortestStop, kLongestStop));
  }
  Trajectory rows;
  std::optional<std::string> fault;
  try {
    rows = stop_rows(robot, Interpolator(plan).at(time), stop);
    fault = fault_of_stop(robot, rows);
  } catch (const NoStop& error) {
    fault = error.what();
  }
  if (fault) refuse(*fault);
  return rows;
}

}  // namespace fjr
