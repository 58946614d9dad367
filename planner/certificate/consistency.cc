#include "planner/certificate/consistency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/certificate/certificate.h"
#include "planner/certificate/thresholds.h"
#include "planner/trajectory/finite.h"

namespace fjr {
namespace {

// All rows of a file at the longest sample period of a request, 5 ms: a rollout of it is over within seconds. [s]
constexpr double kLongestTrajectory = kLongestSpacing * kMaxRows;

// Rollouts do not step over less than a tenth of that. fjr's own rows are at least half of kJumpSpacing apart. [s]
constexpr double kClosestRows = 1e-9;
// [s] ARKODE treats times as equal that are within 100 roundings of each other. Before the end of a trajectory that
// begins here, these are less than a thirtieth of kClosestRows.
constexpr double kLatestStart = 1000;

struct Column {
  const char* name;
  double x0, x1, v0, v1, a0, a1;
  double tolerance;  // [rad/s]

  double disagreement(double h) const { return std::abs((x1 - x0) / h - 0.5 * (v0 + v1)); }
  double allowed(double h) const { return tolerance + h * std::abs(a1 - a0) / 8; }
};

std::optional<std::string> disagreement(const Column& c, std::size_t joint, const Sample& a, const Sample& b) {
  const double h = b.time - a.time;
  if (c.disagreement(h) <= c.allowed(h)) return std::nullopt;
  return fmt::format(
      "{}{} disagrees with its position column by {:.2e} rad/s between {:.6f} s and {:.6f} s, allowed {:.2e}", c.name,
      joint + 1, c.disagreement(h), a.time, b.time, c.allowed(h));
}

// Compares the velocities of one motor with what its accelerations make of them.
class VelocityChanges {
 public:
  explicit VelocityChanges(double unexplained_acceleration) : unexplained_(unexplained_acceleration) {}

  // Includes an interval of duration h [s] with its velocities [rad/s] and the accelerations there [rad/s^2]. Returns
  // the largest change from any earlier row on that neither accelerations nor allowances explain, 0 if there is none.
  double include(double h, double v0, double v1, double a0, double a1) {
    drift_ += v1 - v0 - 0.5 * h * (a0 + a1);
    allowed_ += h * (unexplained_ + 0.5 * std::abs(a1 - a0));  // if it jumps in between
    const double least = drift_ - allowed_, most = drift_ + allowed_;
    const double change = std::max({0.0, least - lowest_, highest_ - most});
    lowest_ = std::min(lowest_, least);
    highest_ = std::max(highest_, most);
    return change;
  }

 private:
  double unexplained_;                                         // [rad/s^2]
  double drift_ = 0, allowed_ = 0, lowest_ = 0, highest_ = 0;  // [rad/s] from the first row on
};

std::optional<std::string> unexplained(double change, std::size_t joint, double time) {
  if (change <= kUnexplainedVelocity) return std::nullopt;
  return fmt::format(
      "dtheta{} changes by {:.2e} rad/s until {:.6f} s that the motor's acceleration does not explain, allowed {:.2e}",
      joint + 1, change, time, kUnexplainedVelocity);
}

}  // namespace

std::optional<std::string> malformed(const Trajectory& trajectory) {
  const std::vector<Sample>& rows = trajectory.samples;
  if (rows.size() < 2) return "the trajectory has fewer than two rows";
  if (rows.size() > kMaxRows)
    return fmt::format("the trajectory has {} rows, at most {} are allowed", rows.size(), kMaxRows);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!is_finite(rows[k])) return fmt::format("row {} holds a value that is not finite", k + 1);
    if (k > 0 && !(rows[k].time > rows[k - 1].time)) {
      return fmt::format("time does not increase at row {} ({:.9f} s after {:.9f} s)", k + 1, rows[k].time,
                         rows[k - 1].time);
    }
    if (k > 0 && rows[k].time - rows[k - 1].time < kClosestRows) {
      return fmt::format("row {} at {:.9f} s is {:.1e} s after the row before it, at least {:.0e} s are needed", k + 1,
                         rows[k].time, rows[k].time - rows[k - 1].time, kClosestRows);
    }
  }
  if (const double duration = trajectory.end_time() - trajectory.start_time(); duration > kLongestTrajectory) {
    return fmt::format("the trajectory takes {:g} s, at most {:g} s are rolled out", duration, kLongestTrajectory);
  }
  if (std::abs(trajectory.start_time()) > kLatestStart) {
    return fmt::format(
        "the trajectory begins at {:g} s, more than {:g} s from time 0: rollouts cannot resolve rows there",
        trajectory.start_time(), kLatestStart);
  }
  return std::nullopt;
}

std::optional<std::string> inconsistent_velocity(const Parameters& p, const Trajectory& trajectory) {
  const std::vector<Sample>& rows = trajectory.samples;
  const Joints<double> allowed = unexplained_acceleration(p);
  Joints<VelocityChanges> changes{VelocityChanges(allowed[0]), VelocityChanges(allowed[1])};
  std::optional<std::string> jump;  // told only if nothing is wrong with the means, which says more
  State<double> f0 = dynamics(p, rows[0].state, rows[0].torque);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const State<double>&x0 = rows[k - 1].state, &x1 = rows[k].state;
    const State<double> f1 = dynamics(p, x1, rows[k].torque);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const Column link{"dq", x0.q[j], x1.q[j], x0.dq[j], x1.dq[j], f0.dq[j], f1.dq[j], link_velocity_tolerance(p)};
      const Column motor{"dtheta",     x0.theta[j],  x1.theta[j],  x0.dtheta[j],
                         x1.dtheta[j], f0.dtheta[j], f1.dtheta[j], motor_velocity_tolerance(p)[j]};
      for (const Column& column : {link, motor}) {
        if (auto text = disagreement(column, j, rows[k - 1], rows[k])) return text;
      }
      const double change =
          changes[j].include(rows[k].time - rows[k - 1].time, x0.dtheta[j], x1.dtheta[j], f0.dtheta[j], f1.dtheta[j]);
      if (!jump) jump = unexplained(change, j, rows[k].time);
    }
    f0 = f1;
  }
  return jump;
}

}  // namespace fjr
