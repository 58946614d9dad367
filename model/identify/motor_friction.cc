// IV-E: average torques at constant speeds, and the friction law (24) through them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/input_error.h"
#include "model/friction.h"
#include "model/identify/checks.h"
#include "model/identify/friction_fit.h"
#include "model/identify/friction_shape.h"
#include "model/identify/procedures.h"
#include "model/identify/row_ranges.h"
#include "model/identify/velocity.h"

namespace fjr {
namespace {

constexpr std::size_t kFewestSpeedRows = 8, kFewestSpeeds = 8;
constexpr double kShortest = 0.2;  // [s] shortest range of constant speed, if there are no commanded speeds
constexpr double kStanding = 1;    // standard errors below which a speed may be standstill, likewise
constexpr double kExactly = 1e-6;  // relative rounding error of a commanded speed in the log
constexpr double kObeyed = 2;      // mean square of deviations from the commands, in standard errors, that is accepted
constexpr double kSkipped = 0.2;   // fraction of each range that is skipped because of the transient

// Returns the ranges in which the commanded speed dtheta<joint>_plan is constant or, without commands, those in which
// the measured speed and torque are.
std::vector<RowRange> constant_speeds(const Log& log, int joint, const Parameters& robot) {
  const std::string planned = joint_column("dtheta", joint, "_plan");
  if (log.has(planned)) return commanded_ranges(log.column(planned));
  const auto rows = static_cast<std::size_t>(kShortest / sample_interval(log));
  return steady_ranges({velocity(log, joint, robot, rows / 4), {log.column(joint_column("tau", joint)), 0}},
                       std::max(rows, kFewestSpeedRows));
}

// If the measured speeds differ from the commanded ones only by their errors, the drive follows its commands. Then the
// commanded speeds are used, with the smaller error that all points together imply. Otherwise a kink narrower than the
// error of a single measured speed would look blunt.
void trust_commands(const std::vector<double>& commands, std::vector<FrictionPoint>& points) {
  double square = 0, error = 0;
  const auto count = static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double allowed = std::hypot(points[i].sigma_v, kExactly * commands[i]);
    square += std::pow((points[i].v - commands[i]) / allowed, 2) / count;
    error += points[i].sigma_v / count;
  }
  if (!(square < kObeyed)) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].v = commands[i];
    points[i].sigma_v = std::min(points[i].sigma_v, error / std::sqrt(count));
  }
}

std::vector<FrictionPoint> averages(const Log& log, int joint, const Parameters& robot,
                                    std::vector<std::string>& warnings) {
  const std::vector<double>& tau = log.column(joint_column("tau", joint));
  std::vector<FrictionPoint> points;
  std::vector<double> commands;
  std::size_t rejected = 0;
  const bool commanded = log.has(joint_column("dtheta", joint, "_plan"));
  const std::vector<RowRange> ranges = constant_speeds(log, joint, robot);
  require_consistent_velocity(log, joint, robot, ranges);
  for (RowRange range : ranges) {
    range.from += static_cast<std::size_t>(kSkipped * static_cast<double>(range.rows()));
    if (range.rows() < kFewestSpeedRows) continue;
    const Speed speed = constant_speed(log, joint, robot, range);
    if (!commanded && std::abs(speed.mean) <= kStanding * speed.standard_error) continue;
    const Average torque = robust_mean(std::span(tau).subspan(range.from, range.rows()));
    rejected += speed.rejected + torque.rejected;
    points.push_back({speed.mean, torque.mean, speed.standard_error, torque.standard_error});
    if (commanded) commands.push_back(log.column(joint_column("dtheta", joint, "_plan"))[range.from]);
  }
  warn_of_outliers(rejected, "samples", warnings);
  if (points.size() < kFewestSpeeds) {
    throw InputError(log.source, joint_column("dtheta", joint),
                     fmt::format("{} constant speeds; at least {} are needed", points.size(), kFewestSpeeds));
  }
  if (commanded) trust_commands(commands, points);
  return points;
}

std::vector<FrictionPoint> without_outliers(const std::vector<FrictionPoint>& points, const Fit& fit) {
  const std::vector<bool> inside = inliers({fit.residuals.data(), points.size()}, 10.0);  // in standard deviations
  std::vector<FrictionPoint> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inside[i]) kept.push_back(points[i]);
  }
  return kept;
}

void check_signs(const Log& log, const std::vector<FrictionPoint>& points, int joint) {
  double power = 0;
  for (const FrictionPoint& point : points) power += point.tau * point.v;
  if (power <= 0) {
    throw InputError(log.source, joint_column("tau", joint), "friction drives the motor: a column has the wrong sign");
  }
}

// Adds the goodness of fit in N m, unlike the residuals of the fit.
void add_goodness(const std::vector<FrictionPoint>& points, const FrictionLaw& law, Estimate& e) {
  double square = 0, total = 0;
  for (const FrictionPoint& point : points) {
    square += std::pow(law.torque(point.v) - point.tau, 2);
    total += point.tau * point.tau;
  }
  e.points = points.size();
  e.residual_unit = "N m";
  e.residual_rms = std::sqrt(square / static_cast<double>(points.size()));
  e.r_squared = 1 - square / total;
}

}  // namespace

Estimate identify_motor_friction(const Log& log, int joint, const Parameters& robot) {
  const auto j = static_cast<std::size_t>(joint);
  Estimate e;
  e.names = {"viscous", "amplitude", "width", "second_weight", "second_shape"};
  e.units = {"N m s/rad", "N m", "rad/s", "1", "1"};
  warn_of_gaps(log, e.warnings);
  std::vector<FrictionPoint> points = averages(log, joint, robot, e.warnings);
  check_signs(log, points, joint);

  Fit fit = best_of_many_starts(log, points, deviations(points, nullptr));
  const std::size_t before = points.size();
  FrictionLaw law = law_of(fit.value);
  fit = finish(points, deviations(points, &law), fit.value, false);
  points = without_outliers(points, fit);
  warn_of_outliers(before - points.size(), "speeds", e.warnings);
  law = law_of(fit.value);
  const std::vector<double> sigma = deviations(points, &law);
  fit = finish(points, sigma, without_unseen_kink(points, fit.value), false);
  double h = shape(fit.value);
  if (!shape_is_known(points, sigma, fit)) fit = assume_shape(points, sigma, fit, robot.friction.second_shape[j], h, e);

  never_below_the_points(fit);
  law = law_of(fit.value);
  law.second_shape = h;  // unrounded, where it was assumed
  e.value.resize(5);
  e.value << law.viscous, law.amplitude, law.width, law.second_weight, law.second_shape;
  e.covariance = in_law_parameters(fit);
  add_goodness(points, law, e);
  e.fitted = points;
  warn_of_doubt(e);
  require_plausible(log, fmt::format("the viscous friction of motor {} [N m s/rad]", joint + 1), law.viscous,
                    robot.friction.viscous[j]);
  require_plausible(log, fmt::format("the amplitude f of motor {} [N m]", joint + 1), law.amplitude,
                    robot.friction.amplitude[j]);
  return e;
}

}  // namespace fjr
