#include "planner/certificate/consistency.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/certificate/certificate.h"
#include "planner/certificate/thresholds.h"

namespace fjr {
namespace {

// All rows of a file at the longest sample period of a request, 5 ms: a rollout of it is over within seconds. [s]
constexpr double kLongestTrajectory = 5e-3 * kMaxRows;

bool finite(const Sample& row) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  std::array<double, kStates> state{};
  row.state.copy_to(state.data());
  return is_finite(row.time) && std::all_of(state.begin(), state.end(), is_finite) &&
         std::all_of(row.torque.begin(), row.torque.end(), is_finite);
}

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

}  // namespace

std::optional<std::string> malformed(const Trajectory& trajectory) {
  const std::vector<Sample>& rows = trajectory.samples;
  if (rows.size() < 2) return "the trajectory has fewer than two rows";
  if (rows.size() > kMaxRows)
    return fmt::format("the trajectory has {} rows, at most {} are allowed", rows.size(), kMaxRows);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!finite(rows[k])) return fmt::format("row {} holds a value that is not finite", k + 1);
    if (k > 0 && !(rows[k].time > rows[k - 1].time)) {
      return fmt::format("time does not increase at row {} ({:.9f} s after {:.9f} s)", k + 1, rows[k].time,
                         rows[k - 1].time);
    }
  }
  if (const double duration = trajectory.end_time() - trajectory.start_time(); duration > kLongestTrajectory) {
    return fmt::format("the trajectory takes {:g} s, at most {:g} s are rolled out", duration, kLongestTrajectory);
  }
  return std::nullopt;
}

std::optional<std::string> inconsistent_velocity(const Parameters& p, const Trajectory& trajectory) {
  const std::vector<Sample>& rows = trajectory.samples;
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
    }
    f0 = f1;
  }
  return std::nullopt;
}

}  // namespace fjr
